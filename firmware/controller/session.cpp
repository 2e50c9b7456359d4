#include "firmware/controller/session.hpp"

#include <spdlog/spdlog.h>

#include <chrono>

namespace antiskid::controller {

namespace {

std::unique_ptr<host::Pacer> make_pacer(const ControllerSetup& setup, const Options& options, can::Bus& bus, host::Clock& clock,
                                        const can::ControllerPort& port, host::FrameIntake& intake) {
    const auto message = host::SensorPacer::message(setup.layout, setup.period);
    if (options.clock == ClockSource::sensors && message)
        return std::make_unique<host::SensorPacer>(clock, setup.period, *message, bus, port, intake);
    if (options.clock != ClockSource::sync) return std::make_unique<host::TimerPacer>(clock, setup.period, intake);
    const can::Signal& number = setup.layout.sync_counter;
    return std::make_unique<host::SyncPacer>(clock, setup.period, std::chrono::milliseconds{options.sync_timeout_ms}, port,
                                             number.bound() ? number.mask() + 1 : 0, intake);
}

}  // namespace

Session::Session(const ControllerSetup& setup, const Options& options, can::Bus& bus, host::Clock& clock)
    : port_(setup.layout, setup.period),
      controller_(setup.control),
      intake_(bus, port_),
      pacer_(make_pacer(setup, options, bus, clock, port_, intake_)),
      loop_({.period = setup.period, .safe_current_mA = setup.control.valve.safe_current_mA, .valve_last = options.clock == ClockSource::sync},
            {.clock = clock, .pacer = *pacer_, .bus = bus, .port = port_, .controller = controller_, .ring = ring_}) {}

LoopThread::LoopThread(host::ControlLoop& loop, const host::RealtimeRequest& request, std::atomic<bool>& stop)
    : stop_(stop), thread_([&loop, request, &stop] {
          for (const std::string& rejected : host::enter_realtime(request)) spdlog::warn(rejected);
          loop.run(stop);
      }) {}

LoopThread::~LoopThread() {
    stop_.store(true, std::memory_order_relaxed);
    thread_.join();
}

}  // namespace antiskid::controller
