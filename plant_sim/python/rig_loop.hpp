/// The rig's side of a scenario, period by period, for a controller written in Python.
#pragma once

#include <memory>

#include "firmware/can/rounded_link.hpp"
#include "plant_sim/python/scenario.hpp"
#include "plant_sim/study/rig_session.hpp"

namespace plant_sim::python {

class RigLoop {
  public:
    explicit RigLoop(std::shared_ptr<const Scenario> scenario);

    [[nodiscard]] bool done() const { return session_.done(); }
    /// Whether the pilot demands pressure, also at standstill.
    [[nodiscard]] bool braking() const { return session_.sample().maneuver.demand_Pa > 0.0F; }
    [[nodiscard]] antiskid::control::Time now() const { return period_ * steps_; }
    [[nodiscard]] double period_s() const;
    [[nodiscard]] const study::RigSession& session() const { return session_; }
    /// Valve current for a pressure by the valve's map.
    [[nodiscard]] double current_for_mA(double pressure_Pa) const;

    /// Sensor values of this period, rounded as in frames.
    [[nodiscard]] const antiskid::control::Sensors& sensors();
    /// Advances by one period with this valve current, which is not rounded. Throws std::runtime_error after the end of the maneuver.
    void advance(double current_mA, antiskid::control::State state = antiskid::control::State::braking);
    /// Advances by one period with a controller's command, rounded as in its frame.
    void apply(const antiskid::control::Command& command);

    [[nodiscard]] py::object figures() const;

  private:
    std::shared_ptr<const Scenario> scenario_;
    study::RigSession session_;
    antiskid::control::Time period_;
    antiskid::can::RoundedLink link_;
    std::int64_t steps_ = 0;
    const antiskid::control::Sensors* sensed_ = nullptr;  // of this period
    antiskid::control::FaultSet faults_;
};

}  // namespace plant_sim::python
