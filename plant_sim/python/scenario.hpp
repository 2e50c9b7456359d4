/// One maneuver for Python: read and checked once, run any number of times.
#pragma once

#include <optional>
#include <vector>

#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/python/bindings.hpp"
#include "plant_sim/scenario/stop_options.hpp"
#include "plant_sim/study/in_process.hpp"

namespace plant_sim::python {

class Scenario {
  public:
    /// Keywords are those of `rig-lab stop`, with units; an unknown one is a TypeError that lists the known ones.
    explicit Scenario(const py::kwargs& keywords);

    [[nodiscard]] const StopInputs& inputs() const { return inputs_; }
    /// As `rig-lab stop --json`.
    [[nodiscard]] py::object figures(const study::RunResult& result, double slip_reference, std::uint64_t seed) const;
    /// Figures of one maneuver over frames, as `rig-lab stop` runs it.
    [[nodiscard]] py::object stop() const;
    /// The same, and an array per column with one value for each control period.
    [[nodiscard]] py::tuple recorded_stop() const;
    /// Runs one maneuver for each reference with that seed, side by side; an array per figure. The values are those of RigLoop.
    [[nodiscard]] py::dict stops(const std::vector<double>& slip, const std::vector<std::uint64_t>& seed, unsigned threads) const;
    /// Open loop, as `rig-lab drive`; an array per column. Exactly one of the two inputs must be given.
    [[nodiscard]] py::dict drive(const std::vector<double>& time_s, const std::optional<std::vector<double>>& pressure_Pa,
                                 const std::optional<std::vector<double>>& current_mA) const;

  private:
    StopOptions options_;
    StopInputs inputs_;
};

}  // namespace plant_sim::python
