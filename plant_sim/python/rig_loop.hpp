/// The rig's side of a scenario, a control period at a time, for a controller that is written in Python.
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
    /// The pilot asks for the brake, or the aircraft stands with it on.
    [[nodiscard]] bool braking() const { return session_.sample().maneuver.demand_Pa > 0.0F; }
    [[nodiscard]] antiskid::control::Time now() const { return period_ * steps_; }
    [[nodiscard]] double period_s() const;
    [[nodiscard]] const study::RigSession& session() const { return session_; }
    /// The current that the valve's map has for a pressure.
    [[nodiscard]] double current_for_mA(double pressure_Pa) const;

    /// What the frames of this period tell a controller, rounded as they are.
    [[nodiscard]] const antiskid::control::Sensors& sensors();
    /// One period with that current at the valve, as it is. Throws std::runtime_error once the maneuver is over.
    void advance(double current_mA, antiskid::control::State state = antiskid::control::State::braking);
    /// One period with what a controller decided, rounded as its frame is.
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
