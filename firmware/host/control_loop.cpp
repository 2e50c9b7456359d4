#include "firmware/host/control_loop.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace antiskid::host {

void ControlLoop::run(const std::atomic<bool>& stop) {
    while (const auto wake = context_.pacer.next(stop)) cycle(*wake);
    send_safe_current();
}

void ControlLoop::cycle(const Wake& wake) {
    const can::LinkStatus link = context_.bus.status();
    context_.port.note_link(link);
    constexpr std::uint64_t kMax = 1'000'000;
    context_.port.note_missed_periods(static_cast<std::uint32_t>(std::min(wake.skipped, kMax)));
    const control::Command command = context_.controller.step(context_.port.sensors(), wake.now);
    context_.port.clear_one_shots();
    const std::uint32_t unsent = send_due(command);

    if (statistics_.steps > 0) statistics_.period.add(wake.woke - last_woke_);
    last_woke_ = wake.woke;
    if (wake.taken.full) ++statistics_.full_drains;
    CycleRecord record{.step = statistics_.steps + 1,
                       .now = wake.now,
                       .latency = wake.latency,
                       .skipped = wake.skipped,
                       .received = static_cast<std::uint32_t>(wake.taken.frames),
                       .unsent = unsent,
                       .synchronised = wake.synchronised,
                       .by_timer = wake.by_timer,
                       .link = link,
                       .command = command};
    if (!settings_.valve_last || statistics_.steps % kTimedSteps == 0) {
        const Time done = context_.clock.now();
        const Time edge = settings_.valve_last ? wake.woke : context_.port.sensors().wheel.received;
        record.work = done - wake.woke;
        if (edge != control::kNever) record.edge_to_command = done - edge;
    }
    statistics_.add(record);
    context_.ring.push(record);
}

std::uint32_t ControlLoop::send_due(const control::Command& command) {
    std::array<can::Frame, can::ControllerPort::kMaxFrames> frames;
    const std::size_t count = context_.port.due_frames(command, frames);
    const auto due = std::span(frames).first(count);
    // The port gives the valve command first, where it is due.
    if (settings_.valve_last && !due.empty()) std::rotate(due.begin(), due.begin() + 1, due.end());
    const std::size_t sent = context_.bus.send_all(due);
    if (sent < count && (settings_.valve_last || sent == 0)) context_.port.note_command_unsent();
    statistics_.frames_sent += sent;
    return static_cast<std::uint32_t>(count - sent);
}

void ControlLoop::send_safe_current() {
    Time next = context_.clock.now();
    for (std::uint32_t attempt = 0; attempt < kSafeAttempts && statistics_.safe_commands_sent < kSafeCommands; ++attempt) {
        if (context_.bus.send(context_.port.valve_command(settings_.safe_current_mA))) ++statistics_.safe_commands_sent;
        next += settings_.period;
        context_.clock.sleep_until(next);
    }
}

}  // namespace antiskid::host
