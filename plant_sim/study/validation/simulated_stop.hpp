/// A stop of the plant by prescribed pressure, remembered as far back as a window between two encoder edges may reach.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "plant_sim/model/rig.hpp"

namespace validation {

class SimulatedStop {
  public:
    /// At `start_s` the wheel rolls freely at `speed_mps` under `pressure_Pa`. The friction curve of the brake stays that of the
    /// parameters' own brake-on speed.
    SimulatedStop(const rig::RigParameters& parameters, double speed_mps, double start_s, double pressure_Pa);

    /// To the last whole millisecond since the start that is not after `time_s`; the pressure goes linearly to `pressure_Pa`
    /// at `time_s`. Times must not fall.
    void advance(double time_s, double pressure_Pa);

    [[nodiscard]] bool standstill() const { return rig_.standstill(); }

    /// Means over a window; over one instant where `to_s` is `from_s`.
    struct Motion {
        double v_mps, omega_radps, radius_m;
    };
    /// None where the window reaches out of what is remembered (two seconds) or before the start.
    [[nodiscard]] std::optional<Motion> mean(double from_s, double to_s) const;

  private:
    struct Instant {
        double distance_m, angle_rad, v_mps, omega_radps, radius_m;
    };
    void remember();
    [[nodiscard]] double newest_s() const;
    [[nodiscard]] std::optional<Instant> at(double time_s) const;

    plant::Rig rig_;
    double start_s_;
    double given_s_, given_Pa_;  // the newest prescribed pressure
    double pressure_Pa_;         // at the end of the last step
    std::int64_t steps_ = 0;
    std::deque<Instant> past_;
};

}  // namespace validation
