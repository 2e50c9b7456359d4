#include "plant_sim/virtual_rig/rig_node.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "firmware/can/roles.hpp"
#include "firmware/can/value_names.hpp"
#include "firmware/host/periodic_timer.hpp"

namespace plant_sim {

using antiskid::can::Frame;
using antiskid::can::RigPort;
using antiskid::can::Role;
using antiskid::control::Time;

namespace {

constexpr Time kMillisecond{1'000'000};
constexpr Time kRepeat = 100 * kMillisecond;  // of the first cycle while there is no controller

double milliseconds(Time t) {
    return static_cast<double>(t.count()) * 1e-6;
}

}  // namespace

struct RigNode::Cycle {
    std::array<Frame, RigPort::kMaxFrames + 1> frames{};
    std::size_t count = 0;
};

RigNode::RigNode(study::RigSession& session, const antiskid::can::Layout& layout, antiskid::can::Bus& bus, antiskid::host::Clock& clock, Time period)
    : session_(session), layout_(layout), bus_(bus), clock_(clock), period_(period), port_(layout, period) {}

RigNode::Cycle RigNode::next_cycle(bool with_sync) {
    antiskid::can::RigSample sample = session_.sample();
    sample.load_cells = session_.load_cells();
    Cycle cycle;
    cycle.count = port_.due_frames(sample, cycle.frames);
    if (with_sync) cycle.frames[cycle.count++] = port_.sync(sync_++);
    return cycle;
}

bool RigNode::send_all(const Cycle& cycle, Time timeout, const std::atomic<bool>& stop) {
    const Time deadline = clock_.now() + timeout;
    for (auto left = std::span(cycle.frames).first(cycle.count);;) {
        const std::size_t taken = bus_.send_all(left);
        result_.frames_sent += taken;
        left = left.subspan(taken);
        if (left.empty()) return true;
        if (!bus_.status().up || stop || clock_.now() >= deadline) return false;
        clock_.sleep_until(clock_.now() + kMillisecond / 10);
    }
}

void RigNode::receive(Time timeout) {
    std::array<Frame, 32> frames{};
    for (std::size_t count = frames.size(); count == frames.size(); timeout = {}) {
        count = timeout > Time{} ? bus_.receive_within(timeout, frames) : bus_.receive(frames);
        for (std::size_t i = 0; i < count; ++i) port_.accept(frames[i]);
        result_.frames_received += count;
    }
    result_.faults.insert(port_.controller().faults);
}

bool RigNode::wait_for_answer(std::uint64_t answers, Time timeout, const std::atomic<bool>& stop) {
    const Time deadline = clock_.now() + timeout;
    for (Time left = timeout;; left = deadline - clock_.now()) {
        receive(std::min(left, kRepeat));
        if (port_.stats(Role::valve).accepted >= answers) return true;
        if (left <= Time{} || stop || !bus_.status().up) return false;
    }
}

NodeResult RigNode::finish(Ending ending, std::string reason) {
    result_.ending = ending;
    result_.reason = std::move(reason);
    for (const Role role : antiskid::can::kToRig) result_.frames_lost += port_.stats(role).lost;
    const antiskid::can::LinkStatus link = bus_.status();
    result_.frames_lost += link.receive_dropped;
    return result_;
}

NodeResult RigNode::finish_link_down() {
    return finish(Ending::link_down, "the CAN interface went down during the run; the valve driver has fallen back to no current");
}

NodeResult RigNode::finish_run() {
    if (session_.abandoned()) {
        return finish(Ending::no_standstill, "the controller is in its safe state: the aircraft is not braked any more; see the faults");
    }
    if (session_.timed_out()) return finish(Ending::no_standstill, "the maneuver did not come to rest");
    return finish(Ending::done, "");
}

NodeResult RigNode::run_lockstep(Time answer_timeout, Time start_timeout, const std::atomic<bool>& stop, const NodeObserver& observe) {
    for (std::uint64_t step = 0; !session_.done(); ++step) {
        if (stop) return finish(Ending::stopped, "stopped by the user");
        const Cycle cycle = next_cycle(true);
        const Time limit = step == 0 ? start_timeout : answer_timeout;
        const Time deadline = clock_.now() + limit;
        const std::uint64_t sent_before = result_.frames_sent;
        bool answered = false;
        do {
            if (!send_all(cycle, limit, stop)) break;
            answered = wait_for_answer(step + 1, step == 0 ? kRepeat : answer_timeout, stop);
        } while (step == 0 && !answered && !stop && bus_.status().up && clock_.now() < deadline);
        result_.frames_sent = sent_before + cycle.count;  // a repeated first cycle counts once: it is the same bytes
        if (!answered) {
            if (stop) return finish(Ending::stopped, "stopped by the user");
            if (!bus_.status().up) return finish_link_down();
            return finish(Ending::silent, fmt::format("antiskid-controller did not answer SYNC {} within {:.0f} ms (valve command 0x{:03X})", step,
                                                      milliseconds(limit), layout_[Role::valve].id));
        }
        const auto current_mA = static_cast<double>(port_.controller().current_mA);
        session_.advance(current_mA, port_.controller().state);
        observe(session_, port_.controller(), current_mA);
    }
    return finish_run();
}

NodeResult RigNode::run_realtime(Time start_timeout, const std::atomic<bool>& stop, const NodeObserver& observe) {
    antiskid::host::PeriodicTimer timer(clock_, period_);
    const Time give_up = clock_.now() + start_timeout;
    bool ready = false;
    while (!session_.done()) {
        const auto tick = timer.wait();
        if (stop) return finish(Ending::stopped, "stopped by the user");
        receive();
        const antiskid::can::ControllerView& view = port_.controller();
        if (!bus_.status().up) return finish_link_down();
        // Until the controller has tested itself the rig stands still and sends its first sample.
        if (!ready) {
            ready = view.state == antiskid::control::State::standby;
            if (!ready && tick.woke >= give_up) {
                return finish(Ending::silent,
                              fmt::format("no antiskid-controller in standby within {:.0f} ms (valve commands 0x{:03X}: {}; state: {})",
                                          milliseconds(start_timeout), layout_[Role::valve].id, port_.stats(Role::valve).accepted,
                                          antiskid::can::kStateNames[static_cast<std::size_t>(view.state)]));
            }
        } else {
            const bool silent = tick.woke - view.command_received > kDriverWatchdog;
            const double current_mA = silent ? 0.0 : static_cast<double>(view.current_mA);
            if (silent && tick.woke - view.command_received > start_timeout) {
                return finish(Ending::silent, "antiskid-controller fell silent during the run; the valve driver has fallen back to no current");
            }
            // The plant advances in real time, also by missed periods.
            for (std::uint64_t passed = 0; passed <= tick.skipped && !session_.done(); ++passed) {
                session_.advance(current_mA, view.state);
                observe(session_, view, current_mA);
            }
            result_.overruns += tick.skipped;
        }
        const Cycle cycle = next_cycle(false);
        const std::size_t taken = bus_.send_all(std::span(cycle.frames).first(cycle.count));
        result_.frames_sent += taken;
        result_.frames_lost += cycle.count - taken;
    }
    return finish_run();
}

}  // namespace plant_sim
