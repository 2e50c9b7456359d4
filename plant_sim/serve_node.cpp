#include "plant_sim/serve_node.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "firmware/can/roles.hpp"
#include "firmware/linux/periodic_timer.hpp"

namespace plant_sim {

using antiskid::can::Frame;
using antiskid::can::Role;
using antiskid::control::Time;

namespace {

constexpr Time kRetry{100'000};

}  // namespace

ServeNode::ServeNode(plc::ServedRig& rig, const antiskid::can::Layout& layout, antiskid::can::Bus& bus,
                     antiskid::rt::Clock& clock, Time period, Exchange exchange)
    : rig_(rig),
      bus_(bus),
      clock_(clock),
      period_(period),
      exchange_(std::move(exchange)),
      port_(layout, period, antiskid::can::kFromRigSensors) {}

void ServeNode::send_sample() {
    std::array<Frame, antiskid::can::RigPort::kMostFrames> frames{};
    const std::size_t due = port_.due_frames(rig_.sample(), frames);
    for (std::size_t i = 0; i < due; ++i) {
        if (!bus_.send(frames[i])) ++state_.frames_lost;
    }
}

/// A SYNC that finds the queue full is worth waiting for: without it the controller would not step.
void ServeNode::send_sync(const std::atomic<bool>& stop) {
    const Frame frame = port_.sync(sync_++);
    const Time deadline = clock_.now() + answer_timeout_;
    while (!bus_.send(frame)) {
        if (!bus_.status().up || stop || clock_.now() >= deadline) {
            ++state_.frames_lost;
            return;
        }
        clock_.sleep_until(clock_.now() + kRetry);
    }
}

void ServeNode::receive() {
    std::array<Frame, 32> frames{};
    for (std::size_t count = frames.size(); count == frames.size();) {
        count = bus_.receive(frames);
        for (std::size_t i = 0; i < count; ++i) port_.accept(frames[i]);
    }
    state_.link_up = bus_.status().up;
}

void ServeNode::await_answer(const std::atomic<bool>& stop) {
    const Time deadline = clock_.now() + answer_timeout_;
    receive();
    while (port_.stats(Role::valve).accepted == commands_ && state_.link_up && !stop) {
        const Time left = deadline - clock_.now();
        if (left.count() <= 0) break;
        bus_.wait(left);
        receive();
    }
}

/// It answers the SYNCs that it missed: only the last answer belongs to this period.
void ServeNode::catch_up(const std::atomic<bool>& stop) {
    const Time deadline = clock_.now() + answer_timeout_;
    std::uint32_t heard = commands_;
    while (port_.stats(Role::valve).accepted != heard && !stop && clock_.now() < deadline) {
        heard = port_.stats(Role::valve).accepted;
        clock_.sleep_until(clock_.now() + kQuiet);
        receive();
    }
}

void ServeNode::advance() {
    exchange_(rig_);
    const std::uint32_t accepted = port_.stats(Role::valve).accepted;
    command_age_ = accepted == commands_ ? command_age_ + period_ : Time{};
    commands_ = accepted;
    const bool obeys = command_age_ <= kDriverWatchdog;
    rig_.advance(obeys ? static_cast<double>(port_.controller().current_mA) : 0.0);

    state_.controller_heard = obeys;
    const plc::VirtualPlc& plc = rig_.plc();
    state_.trip = plc.state() == rig::PlcState::tripped ? plc.trip() : plc::Trip::none;
    state_.refused = plc.refused_commit() * 256U + static_cast<std::uint32_t>(plc.refusal());
    ++state_.periods;
    if (rig_.brake() && rig_.brake()->state().maneuvers != maneuvers_) {
        brake_states_.push(rig_.brake()->state());
        maneuvers_ = rig_.brake()->state().maneuvers;
    }
}

void ServeNode::run_lockstep(const std::atomic<bool>& stop, Time answer_timeout) {
    answer_timeout_ = answer_timeout;
    bool silent = true;
    Time next = clock_.now();
    while (!stop) {
        send_sample();
        send_sync(stop);
        if (silent)
            receive();
        else
            await_answer(stop);
        const bool answered = port_.stats(Role::valve).accepted != commands_;
        if (silent && answered) catch_up(stop);
        silent = !answered;
        advance();
        next = std::max(next + period_, clock_.now());
        clock_.sleep_until(next);
    }
}

void ServeNode::run_realtime(const std::atomic<bool>& stop) {
    antiskid::rt::PeriodicTimer timer(clock_, period_);
    while (!stop) {
        const auto tick = timer.wait();
        receive();
        // The plant lives in the machine's time: periods that were missed have passed for it, too.
        for (std::uint64_t passed = 0; passed <= tick.skipped && !stop; ++passed) advance();
        state_.overruns += tick.skipped;
        send_sample();
    }
}

}  // namespace plant_sim
