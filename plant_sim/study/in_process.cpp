#include "plant_sim/study/in_process.hpp"

#include <algorithm>
#include <array>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/control/controller.hpp"
#include "plant_sim/study/loop.hpp"

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
    FrameLink(const Layout& layout, Time period, const FrameObserver& observe)
        : rig_(layout, period), controller_(layout, period), layout_(layout), observe_(observe) {}

    Command cycle(const RigSession& session, Controller& controller, Time now, RunResult& result) {
        antiskid::can::RigSample sample = session.sample();
        sample.load_cells = session.load_cells();
        std::array<Frame, RigPort::kMaxFrames + 1> sent{};
        std::size_t count = rig_.due_frames(sample, sent);
        if (layout_[antiskid::can::Role::sync].bound) sent[count++] = rig_.sync(static_cast<std::uint32_t>(result.steps));
        for (std::size_t i = 0; i < count; ++i) {
            sent[i].received = now;
            if (observe_) observe_(sent[i]);
            controller_.accept(sent[i]);
        }
        const Command command = controller.step(controller_.sensors(), now);
        controller_.clear_one_shots();
        std::array<Frame, ControllerPort::kMaxFrames> answer{};
        const std::size_t answers = controller_.due_frames(command, answer);
        // In lockstep the valve command, first of what is due, is sent last: the rig moves on when it has it.
        std::rotate(answer.begin(), answer.begin() + 1, answer.begin() + static_cast<std::ptrdiff_t>(answers));
        for (std::size_t i = 0; i < answers; ++i) {
            answer[i].received = now;
            if (observe_) observe_(answer[i]);
            rig_.accept(answer[i]);
        }
        result.frames_sent += count;
        result.frames_received += answers;
        return command;
    }

    [[nodiscard]] const antiskid::can::ControllerView& view() const { return rig_.controller(); }
    [[nodiscard]] double current_mA() const { return static_cast<double>(view().current_mA); }
    [[nodiscard]] antiskid::control::State state() const { return view().state; }

  private:
    RigPort rig_;
    ControllerPort controller_;
    const Layout& layout_;
    const FrameObserver& observe_;
};

}  // namespace

RunResult run_in_process(const antiskid::control::Config& config, const Layout& layout, const rig::RigParameters& rig, const SessionOptions& options,
                         Link link, const StepObserver& on_step, const FrameObserver& on_frame) {
    const Time period = period_of(config);
    if (link == Link::rounded) return Loop(config, rig, options, ValueLink(layout, period)).run(on_step);
    return Loop(config, rig, options, FrameLink(layout, period, on_frame)).run(on_step);
}

}  // namespace study
