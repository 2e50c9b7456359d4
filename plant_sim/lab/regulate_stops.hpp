/// The landings of a regulated life in closed loop: sensors, codec rounding, the real controller and the plant, energies as the rig's meter
/// counts them. And the table of J_mu that bounds the reference, made of such landings.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "firmware/can/layout.hpp"
#include "firmware/control/config.hpp"
#include "plant_sim/model/load_rig.hpp"
#include "plant_sim/study/regulation/life.hpp"
#include "plant_sim/study/regulation/order.hpp"

namespace plant_sim {

/// Every surface under every maneuver of the configuration.
struct LandingSite {
    std::string surface;
    std::string maneuver;
    plant::LoadedRig rig;

    [[nodiscard]] double kinetic_J()
        const;  ///< at brake-on, after what the wheel's spin-up has cost the aircraft
};

struct LandingSites {
    std::vector<LandingSite> sites;
    antiskid::control::Config controller;
    antiskid::can::Layout layout;
    std::vector<std::filesystem::path> files;  ///< that were read

    /// Mean and deviation of a landing's energy where every site is as likely as any other.
    [[nodiscard]] double mean_J() const;
    [[nodiscard]] double deviation_J() const;
};

/// Throws settings::Error naming file, line and key.
[[nodiscard]] LandingSites load_sites(const std::filesystem::path& config);

/// One landing; Draw::scenario counts the sites. Throws std::runtime_error, naming the landing, when the aircraft did not come to rest.
[[nodiscard]] regulation::Stop land(const LandingSites& sites, const regulation::Draw& draw, double reference,
                                    double mean_friction);

struct CharacteriseOptions {
    std::vector<double> references;  ///< rising
    std::uint64_t seed = 1;
    unsigned threads = 1;
    const std::atomic<bool>* stop = nullptr;
    std::function<void(int stops)> on_stop{};  ///< one call at a time, by any thread
};
/// All sites with every reference, the brake new and worn out. Empty when it was stopped.
[[nodiscard]] regulation::Characterisation characterise(const LandingSites& sites,
                                                        const CharacteriseOptions& options);
/// How many stops that takes.
[[nodiscard]] int characterising_stops(const LandingSites& sites, const CharacteriseOptions& options);

}  // namespace plant_sim
