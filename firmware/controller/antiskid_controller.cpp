/// antiskid-controller: the anti-skid controller on a CAN interface. See --help.

#include <fmt/core.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>

#include "firmware/can/roles.hpp"
#include "firmware/can/socket_can.hpp"
#include "firmware/controller/controller_check.hpp"
#include "firmware/controller/report.hpp"
#include "firmware/controller/service_manager.hpp"
#include "firmware/controller/session.hpp"
#include "firmware/controller/telemetry.hpp"
#include "firmware/host/settings/command_line.hpp"
#include "firmware/host/stop_signals.hpp"
#include "firmware/host/supervised_can.hpp"

namespace {

using namespace antiskid;
using namespace std::chrono_literals;

/// Until `stop`: log, tell the service manager that the loop goes on, and bring a vanished interface back.
void supervise(const std::atomic<bool>& stop, host::Clock& clock, host::CycleRing& ring, controller::Telemetry& telemetry,
               controller::ServiceManager& service, host::SupervisedCan& bus) {
    constexpr int kTurnsPerSecond = 50;
    constexpr int kTurnsPerRetry = 10;
    std::string last_reason;
    for (int turn = 1; !stop; ++turn) {
        clock.sleep_until(clock.now() + host::Time{1s} / kTurnsPerSecond);
        telemetry.drain(ring);
        service.update(clock.now(), telemetry.cycles());
        if (turn % kTurnsPerSecond == 0) telemetry.summarise(ring);
        if (turn % kTurnsPerRetry != 0) continue;
        const std::string reason = bus.service();
        if (!reason.empty() && reason != last_reason) spdlog::warn("cannot reopen the bus yet: {}", reason);
        last_reason = reason;
    }
}

int finish(const controller::Options& options, const controller::RunReport& report) {
    if (options.json != "-") fmt::print("{}", controller::table(report));
    settings::deliver(options.json, controller::json(report));
    if (report.loop.safe_commands_sent >= host::ControlLoop::kSafeCommands) return 0;
    spdlog::error("the valve's safe current was delivered {} of {} times: {} does not take frames", report.loop.safe_commands_sent,
                  host::ControlLoop::kSafeCommands, options.interface);
    return 1;
}

can::SocketCanOptions socket_options(const controller::ClockSource clock, const controller::ControllerSetup& setup) {
    can::SocketCanOptions socket;
    // In lockstep nothing is late, and a look at the queue costs a system call.
    socket.newest_only = clock != controller::ClockSource::sync;
    const auto message = host::SensorPacer::message(setup.layout, setup.period);
    if (clock == controller::ClockSource::sensors && message) socket.wakes = setup.layout[*message].id;
    return socket;
}

int run(const controller::Options& options, const controller::ControllerSetup& setup) {
    host::StopSignals signals;
    if (const auto rejected = host::lock_memory()) spdlog::warn(*rejected);
    const can::IdList wanted = can::ids(setup.layout, can::kToController);
    const can::SocketCanOptions socket = socket_options(options.clock, setup);
    host::SupervisedCan bus([&options, &wanted, &socket] { return std::make_unique<can::SocketCan>(options.interface, wanted.span(), socket); });
    host::MonotonicClock clock;
    const auto session = std::make_unique<controller::Session>(setup, options, bus, clock);
    controller::ServiceManager service = controller::ServiceManager::of_this_process();
    controller::Telemetry telemetry(*spdlog::default_logger(), options.interface);
    const std::string clock_name(controller::name(options.clock));
    spdlog::info("antiskid-controller {} on {}, {} us by {}, configuration {}", ANTISKID_VERSION, options.interface, setup.period / 1us, clock_name,
                 setup.config_hash);
    {
        const controller::LoopThread loop(session->loop(), options.realtime, signals.stop());
        supervise(signals.stop(), clock, session->ring(), telemetry, service, bus);
        service.stopping();
    }
    telemetry.drain(session->ring());
    spdlog::info("ended by signal {}", signals.number());
    return finish(options, {.interface = options.interface,
                            .clock = clock_name,
                            .config_hash = setup.config_hash,
                            .period = setup.period,
                            .records_lost = session->ring().dropped(),
                            .link = bus.status(),
                            .layout = setup.layout,
                            .port = session->port(),
                            .loop = session->loop().statistics()});
}

}  // namespace

int main(int argc, char** argv) {
    int status_of_error = 2;  // until command line and configuration have been found good
    try {
        spdlog::set_default_logger(spdlog::stderr_logger_mt("antiskid-controller"));
        spdlog::set_pattern("%n: %l: %v");
        const auto parsed = controller::parse_options(argc, argv);
        if (const int* status = std::get_if<int>(&parsed)) return *status;
        const auto& options = std::get<controller::Options>(parsed);
        spdlog::set_level(options.log_level);
        if (options.check) {
            status_of_error = 1;
            return controller::check_controller(options);
        }
        const controller::ControllerSetup setup = controller::load_setup(options);
        status_of_error = 1;
        return run(options, setup);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "antiskid-controller: error: %s\n", error.what());
        return status_of_error;
    }
}
