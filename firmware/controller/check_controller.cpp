#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <future>

#include "firmware/can/socket_can.hpp"
#include "firmware/controller/controller_check.hpp"
#include "firmware/host/realtime.hpp"
#include "firmware/host/seconds.hpp"
#include "firmware/host/settings/progress.hpp"
#include "firmware/host/stop_signals.hpp"

namespace antiskid::controller {

namespace {

using namespace std::chrono_literals;

/// A line on standard error, redrawn in place on a terminal.
void show_progress(control::Time passed, control::Time expected) {
    constexpr std::size_t kWidth = 30;
    fmt::print(stderr, "\r[{}] {:.0f} of {:.0f} s", settings::bar(host::seconds(passed) / host::seconds(expected), kWidth), host::seconds(passed),
               host::seconds(expected));
}

void on_loop_thread(const host::RealtimeRequest& request, control::Time expected, const std::function<void()>& work) {
    const bool terminal = ::isatty(STDERR_FILENO) == 1;
    const auto began = std::chrono::steady_clock::now();
    auto done = std::async(std::launch::async, [&] {
        (void)host::enter_realtime(request);  // what was refused is a check of its own
        work();
    });
    while (done.wait_for(100ms) != std::future_status::ready)
        if (terminal) show_progress(std::chrono::steady_clock::now() - began, expected);
    if (terminal) fmt::print(stderr, "\r\x1b[K");
    done.get();
}

}  // namespace

int check_controller(const controller::Options& options) {
    host::StopSignals signals;
    host::MonotonicClock clock;
    const CheckContext context{
        .machine = [](const MachineNeeds& needs) { return machine_facts(needs); },
        .link = [](const std::string& interface) { return can_link(interface); },
        .open = [&options](std::span<const std::uint16_t> ids) { return std::make_unique<can::SocketCan>(options.interface, ids); },
        .clock = clock,
        .on_loop_thread = [&options](control::Time expected,
                                     const std::function<void()>& work) { on_loop_thread(options.realtime, expected, work); }};
    const Report report = controller_report(options, context, signals.stop());
    const int status = deliver(report, options.json);
    if (signals.number() == 0) return status;
    fmt::print(stderr, "antiskid-controller: ended by signal {} before its time\n", signals.number());
    return 128 + signals.number();
}

}  // namespace antiskid::controller
