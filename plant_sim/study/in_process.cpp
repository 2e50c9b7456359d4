#include "plant_sim/study/in_process.hpp"

#include <algorithm>
#include <array>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/control/controller.hpp"
#include "plant_sim/study/rounded_loop.hpp"

namespace study {

namespace {

using antiskid::can::ControllerPort;
using antiskid::can::Frame;
using antiskid::can::Layout;
using antiskid::can::RigPort;
using antiskid::control::Command;
using antiskid::control::Controller;
using antiskid::control::Time;

/// Both ends of the bus, frame by frame, in the order of the lockstep protocol: sensors, SYNC, the
/// controller's answer.
class FrameLink {
  public:
    FrameLink(const Layout& layout, Time step)
        : rig_(layout, step), controller_(layout, step), layout_(layout) {}

    Command cycle(const RigSession& session, Controller& controller, std::uint64_t step, Time now,
                  RunResult& result, const FrameObserver& observe) {
        antiskid::can::RigSample sample = session.sample();
        sample.load_cells = session.load_cells();
        std::array<Frame, RigPort::kMostFrames + 1> sent{};
        std::size_t count = rig_.due_frames(sample, sent);
        if (layout_[antiskid::can::Role::sync].bound)
            sent[count++] = rig_.sync(static_cast<std::uint32_t>(step));
        for (std::size_t i = 0; i < count; ++i) {
            sent[i].received = now;
            if (observe) observe(sent[i]);
            controller_.accept(sent[i]);
        }
        const Command command = controller.step(controller_.sensors(), now);
        controller_.clear_one_shots();
        std::array<Frame, ControllerPort::kMostFrames> answer{};
        const std::size_t answers = controller_.due_frames(command, answer);
        // In lockstep the valve command, first of what is due, is sent last: the rig moves on when it has it.
        std::rotate(answer.begin(), answer.begin() + 1,
                    answer.begin() + static_cast<std::ptrdiff_t>(answers));
        for (std::size_t i = 0; i < answers; ++i) {
            answer[i].received = now;
            if (observe) observe(answer[i]);
            rig_.accept(answer[i]);
        }
        result.frames_sent += count;
        result.frames_received += answers;
        return command;
    }

    [[nodiscard]] const antiskid::can::ControllerView& view() const { return rig_.controller(); }

  private:
    RigPort rig_;
    ControllerPort controller_;
    const Layout& layout_;
};

RunResult run_frames(const antiskid::control::Config& config, const Layout& layout,
                     const plant::RigParameters& rig, const SessionOptions& options,
                     const StepObserver& on_step, const FrameObserver& on_frame) {
    RunResult result;
    RigSession session(rig, options);
    Controller controller(config);
    const Time period = period_of(config);
    FrameLink frames(layout, period);
    while (!session.done()) {
        const Time now = period * static_cast<std::int64_t>(result.steps);
        const Command command = frames.cycle(session, controller, result.steps, now, result, on_frame);
        const antiskid::can::ControllerView& view = frames.view();
        const auto current_mA = static_cast<double>(view.current_mA);
        result.faults.insert(command.faults);
        session.advance(current_mA, view.state);
        ++result.steps;
        if (on_step) on_step(session, view, current_mA);
    }
    result.figures = session.figures();
    result.came_to_rest = result.figures.standstill;
    return result;
}

RunResult run_rounded(const antiskid::control::Config& config, const Layout& layout,
                      const plant::RigParameters& rig, const SessionOptions& options,
                      const StepObserver& on_step) {
    RoundedLoop loop(config, layout, rig, options);
    RigSession& session = loop.session();
    while (!session.done()) {
        const Command& command = loop.control();
        session.advance(loop.current_mA(), command.state);
        if (on_step) on_step(session, loop.view(), loop.current_mA());
    }
    return loop.result();
}

}  // namespace

RunResult run_in_process(const antiskid::control::Config& config, const Layout& layout,
                         const plant::RigParameters& rig, const SessionOptions& options, Link link,
                         const StepObserver& on_step, const FrameObserver& on_frame) {
    return link == Link::rounded ? run_rounded(config, layout, rig, options, on_step)
                                 : run_frames(config, layout, rig, options, on_step, on_frame);
}

}  // namespace study
