#include "plant_sim/virtual_rig/serve_node.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "firmware/can/roles.hpp"
#include "firmware/host/periodic_timer.hpp"

namespace plant_sim {

using antiskid::can::Frame;
using antiskid::can::Role;
using antiskid::control::Time;

namespace {

constexpr Time kRetry{100'000};

}  // namespace

ServeNode::ServeNode(plc::ServedRig& rig, const antiskid::can::Layout& layout, antiskid::can::Bus& bus, antiskid::host::Clock& clock, Time period,
                     Exchange exchange)
    : rig_(rig),
      bus_(bus),
      clock_(clock),
      period_(period),
      exchange_(std::move(exchange)),
      layout_(layout),
      port_(layout, period, antiskid::can::kFromRigSensors) {}

void ServeNode::send_sample() {
    std::array<Frame, antiskid::can::RigPort::kMaxFrames> frames{};
    const std::size_t due = port_.due_frames(rig_.sample(), frames);
    state_.frames_lost += due - bus_.send_all(std::span(frames).first(due));
}

/// Sends SYNC together with the sample in one call. A SYNC for which the queue has no room is waited for: without it the controller would not step.
void ServeNode::send_sample_and_sync(const std::atomic<bool>& stop) {
    std::array<Frame, antiskid::can::RigPort::kMaxFrames + 1> frames{};
    const std::size_t due = port_.due_frames(rig_.sample(), frames);
    const Frame& sync = frames[due] = port_.sync(sync_++);
    const std::size_t taken = bus_.send_all(std::span(frames).first(due + 1));
    if (taken > due) return;
    state_.frames_lost += due - taken;
    const Time deadline = clock_.now() + answer_timeout_;
    while (!bus_.send(sync)) {
        if (!bus_.status().up || stop || clock_.now() >= deadline) {
            ++state_.frames_lost;
            return;
        }
        clock_.sleep_until(clock_.now() + kRetry);
    }
}

void ServeNode::receive(Time timeout) {
    std::array<Frame, 32> frames{};
    for (std::size_t count = frames.size(); count == frames.size(); timeout = {}) {
        count = timeout > Time{} ? bus_.receive_within(timeout, frames) : bus_.receive(frames);
        for (std::size_t i = 0; i < count; ++i) port_.accept(frames[i]);
    }
    state_.link_up = bus_.status().up;
}

void ServeNode::await_answer(const std::atomic<bool>& stop) {
    const Time deadline = clock_.now() + answer_timeout_;
    for (Time left = answer_timeout_; left > Time{}; left = deadline - clock_.now()) {
        receive(left);
        if (port_.stats(Role::valve).accepted != commands_ || !state_.link_up || stop) return;
    }
}

/// Number of the newest SYNC, modulo its field.
std::uint32_t ServeNode::sync_number() const {
    const antiskid::can::Signal& counter = layout_.sync_counter;
    return (sync_ - 1) & (counter.bound() ? static_cast<std::uint32_t>(counter.mask()) : ~0U);
}

/// Gives the bridge its turn: it reads the present registers and bus, and writes and sends before time advances.
void ServeNode::await_bridge(const std::atomic<bool>& stop) {
    constexpr Time kFirstLook{50'000}, kLongestLook{500'000};  // a look takes the processor from a bridge that shares it
    const auto every = static_cast<std::uint32_t>(std::max<std::int64_t>(kBridgeStep / period_, 1));
    if (!bridge_.done || sync_number() % every != 0) return;
    std::uint16_t seen = bridge_.done();
    if (seen == silent_at_) return;  // also if there is no bridge
    const std::uint16_t wanted = rig::turn_number(sync_number(), every);
    const Time deadline = clock_.now() + answer_timeout_;
    Time look = kFirstLook;
    for (Time now = clock_.now(); seen != wanted && seen != rig::kNoTurns && !stop && now < deadline; now = clock_.now()) {
        clock_.sleep_until(now + look);
        look = std::min(2 * look, kLongestLook);
        seen = bridge_.done();
    }
    silent_at_ = seen == wanted ? rig::kNoTurns : seen;
}

void ServeNode::begin_together(const std::atomic<bool>& stop) {
    constexpr Time kResendAfter{100'000'000};
    while (bridge_.done && bridge_.done() == rig::kNoTurns && !stop) clock_.sleep_until(clock_.now() + kResendAfter / 100);
    std::array<Frame, antiskid::can::RigPort::kMaxFrames + 1> frames{};
    std::size_t count = port_.due_frames(rig_.sample(), frames);
    frames[count++] = port_.sync(sync_++);
    while (port_.stats(Role::valve).accepted == commands_ && !stop) {
        (void)bus_.send_all(std::span(frames).first(count));
        for (const Time end = clock_.now() + kResendAfter; port_.stats(Role::valve).accepted == commands_ && clock_.now() < end && !stop;)
            receive(end - clock_.now());
    }
}

/// The controller answers the SYNCs that it missed; only the last answer belongs to this period.
void ServeNode::catch_up(const std::atomic<bool>& stop) {
    const Time deadline = clock_.now() + answer_timeout_;
    std::uint32_t received = commands_;
    while (port_.stats(Role::valve).accepted != received && !stop && clock_.now() < deadline) {
        received = port_.stats(Role::valve).accepted;
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
    const float current_mA = obeys ? port_.controller().current_mA : 0.0F;
    rig_.advance(static_cast<double>(current_mA));

    state_.controller_heard = obeys;
    state_.current_mA = current_mA;
    state_.slip_reference = port_.controller().slip_reference;
    const plc::VirtualPlc& plc = rig_.plc();
    state_.trip = plc.state() == rig::PlcState::tripped ? plc.trip() : plc::Trip::none;
    state_.rejected = plc.rejected_commit() * 256U + static_cast<std::uint32_t>(plc.rejection());
    ++state_.periods;
    if (rig_.brake() && rig_.brake()->state().maneuvers != maneuvers_) {
        brake_states_.push(rig_.brake()->state());
        maneuvers_ = rig_.brake()->state().maneuvers;
    }
}

void ServeNode::run_lockstep(const std::atomic<bool>& stop, Time answer_timeout, LockstepBridge bridge) {
    answer_timeout_ = answer_timeout;
    bridge_ = std::move(bridge);
    if (bridge_.start_together) {
        begin_together(stop);
        await_bridge(stop);
        advance();
    }
    bool silent = !bridge_.start_together;
    Time next = clock_.now();
    while (!stop) {
        send_sample_and_sync(stop);
        if (silent)
            receive();
        else
            await_answer(stop);
        const bool answered = port_.stats(Role::valve).accepted != commands_;
        if (silent && answered) catch_up(stop);
        silent = !answered;
        await_bridge(stop);
        advance();
        next += period_;
        if (const Time now = clock_.now(); now < next)
            clock_.sleep_until(next);
        else
            next = now;  // not made up for
    }
}

void ServeNode::run_realtime(const std::atomic<bool>& stop) {
    antiskid::host::PeriodicTimer timer(clock_, period_);
    while (!stop) {
        period(timer.wait().skipped);
    }
}

void ServeNode::period(std::uint64_t missed) {
    receive();
    // The plant advances in real time, also by missed periods.
    for (std::uint64_t passed = 0; passed <= missed; ++passed) advance();
    state_.overruns += missed;
    send_sample();
}

}  // namespace plant_sim
