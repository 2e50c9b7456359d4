/// One maneuver in closed loop, period by period: session, controller, and the link between them.
#pragma once

#include <cmath>
#include <utility>

#include "firmware/can/rounded_link.hpp"
#include "firmware/control/controller.hpp"
#include "plant_sim/study/in_process.hpp"

namespace study {

[[nodiscard]] inline antiskid::control::Time period_of(const antiskid::control::Config& controller) {
    return antiskid::control::Time(std::llround(static_cast<double>(controller.period_s) * 1e6) * 1000);
}

/// Implements Link::rounded.
class ValueLink {
  public:
    /// `layout` must outlive the link.
    ValueLink(const antiskid::can::Layout& layout, antiskid::control::Time period) : link_(layout, period) {}

    const antiskid::control::Command& cycle(const RigSession& session, antiskid::control::Controller& controller, antiskid::control::Time now,
                                            RunResult&) {
        now_ = now;
        command_ = controller.step(link_.sense(session.sample(), now), now);
        current_mA_ = static_cast<double>(link_.current_mA(command_));
        return command_;
    }
    [[nodiscard]] double current_mA() const { return current_mA_; }
    [[nodiscard]] antiskid::control::State state() const { return command_.state; }
    /// The rig's view of the controller after the last cycle, without the frames' rounding and rates.
    [[nodiscard]] antiskid::can::ControllerView view() const {
        return {.command_received = now_,
                .current_mA = static_cast<float>(current_mA_),
                .status_received = now_,
                .state = command_.state,
                .slip = command_.slip,
                .slip_reference = command_.slip_reference,
                .speed_mps = command_.speed_mps,
                .faults_received = now_,
                .faults = command_.faults,
                .road_received = now_,
                .road = command_.road,
                .heartbeat_received = now_};
    }

  private:
    antiskid::can::RoundedLink link_;
    antiskid::control::Command command_;
    antiskid::control::Time now_{};
    double current_mA_ = 0.0;
};

/// `LinkPolicy` has cycle(), current_mA(), state() and view() like ValueLink; it may count frames in the result.
template <typename LinkPolicy>
class Loop {
  public:
    Loop(const antiskid::control::Config& controller, const rig::RigParameters& rig, const SessionOptions& options, LinkPolicy link)
        : session_(rig, options), controller_(controller), period_(period_of(controller)), link_(std::move(link)) {}

    /// First half of a period: passes the sensor values to the controller and its command to the link. The caller then advances the session with the
    /// link's current and state.
    void control() {
        const auto now = period_ * static_cast<std::int64_t>(result_.steps);
        result_.faults.insert(link_.cycle(session_, controller_, now, result_).faults);
        ++result_.steps;
    }
    RunResult run(const StepObserver& on_step) {
        while (!session_.done()) {
            control();
            session_.advance(link_.current_mA(), link_.state());
            if (on_step) on_step(session_, link_.view(), link_.current_mA());
        }
        return result();
    }
    [[nodiscard]] RigSession& session() { return session_; }
    [[nodiscard]] LinkPolicy& link() { return link_; }
    [[nodiscard]] RunResult result() const {
        RunResult result = result_;
        result.figures = session_.figures();
        result.came_to_rest = result.figures.standstill;
        return result;
    }

  private:
    RigSession session_;
    antiskid::control::Controller controller_;
    antiskid::control::Time period_;
    LinkPolicy link_;
    RunResult result_;
};

}  // namespace study
