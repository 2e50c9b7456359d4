/// A tyre from the command line, in the place of the one that the rig's file has.
#pragma once

#include <string>
#include <vector>

#include "firmware/host/settings/command_line.hpp"
#include "rig_bridge/rig/compliance.hpp"

namespace plant_sim {

/// The keys of [tyre] in the rig's file. Numbers may be lists: then every combination of them is a tyre.
struct TyreOptions {
    std::string model;  ///< empty: as the rig's file has it
    std::vector<double> belt_share{0.35}, frequency_Hz{80.0}, damping{0.06};
    std::vector<double> length_m{0.20}, floor_m{0.02};

    void add_to(CLI::App& app);

    /// One at least; `own` where none is named. Throws std::invalid_argument where a number belongs to another model.
    [[nodiscard]] std::vector<plant::Compliance> tyres(const plant::Compliance& own) const;

  private:
    std::vector<const CLI::Option*> of_ring_, of_relaxation_;
};

}  // namespace plant_sim
