/// The pilot of a maneuver: approach, touchdown, brake-on with a step to full demand, standstill, release.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "firmware/can/rig_sample.hpp"

namespace study {

/// Commands to the controller and their times, counted from the start of the run.
struct ManeuverPlan {
    antiskid::control::Law law = antiskid::control::Law::wheel_slip;
    double slip_reference = 0.24;
    double deceleration_mps2 = 0.0;  ///< reference of the deceleration law
    double demand_Pa = 0.0;          ///< at brake-on the demand steps from zero to this

    /// Valve current of the open-loop law over time since brake-on: linear between points, constant before the first and after the last.
    struct CurrentPoint {
        double time_s;
        double current_mA;
    };
    std::vector<CurrentPoint> current;

    double arm_s = 0.2;  ///< the controller's self-test is finished by then
    double touchdown_s = 0.5;
    double settle_s = 1.0;            ///< from touchdown to brake-on: the wheel spins up and rolls freely
    double after_standstill_s = 0.1;  ///< demand held before the release
    double release_s = 0.1;           ///< disarmed until the run ends
};

enum class StopPhase { approach, rolling, braking, standstill, released, done };
inline constexpr std::array<std::string_view, 6> kStopPhaseNames{"approach", "rolling", "braking", "standstill", "released", "done"};
[[nodiscard]] constexpr std::string_view name(StopPhase phase) {
    return kStopPhaseNames[static_cast<std::size_t>(phase)];
}

class Pilot {
  public:
    explicit Pilot(ManeuverPlan plan);

    /// Call once a period. `standstill`: whether the aircraft stands. Phases only advance.
    void update(double time_s, bool standstill);

    [[nodiscard]] StopPhase phase() const { return phase_; }
    [[nodiscard]] double brake_on_s() const { return plan_.touchdown_s + plan_.settle_s; }
    [[nodiscard]] antiskid::can::ManeuverSample command() const;
    [[nodiscard]] const ManeuverPlan& plan() const { return plan_; }

  private:
    [[nodiscard]] double open_loop_mA() const;

    ManeuverPlan plan_;
    StopPhase phase_ = StopPhase::approach;
    double time_s_ = 0.0;
    double stood_at_s_ = 0.0;
};

}  // namespace study
