// The loop allocates nothing, takes no lock, prints nothing, throws nothing: counted by traps in front of the C library, over the real
// loop, in every clock, law and plight. The last test shows that the traps work.
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <memory>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "tests/catch.hpp"
#include "tests/host/loop_bench.hpp"
#include "tests/host/toy_rig.hpp"
#include "tests/host/traps.hpp"

using namespace host_test;
using controller::ClockSource;
using traps::Call;

namespace {

constexpr int kPeriods = 10'000;

/// What goes wrong while the loop runs.
enum class Disturbance { none, link_lost, silence, damage, overruns };

/// The test's own part of a period, which may do what it likes.
void act(LoopBench& bench, ToyRig& rig, const Disturbance disturbance, const int period) {
    const traps::Disarmed disarmed;
    const bool trouble = period % 1000 >= 900;
    if (disturbance == Disturbance::link_lost) bench.controller_end.set_link(!trouble, trouble && period % 2000 > 1000);
    if (disturbance == Disturbance::overruns && trouble) bench.clock.advance(2500us);
    if (disturbance == Disturbance::silence && trouble) return;
    bench.rig_period(rig.sample());
    if (disturbance == Disturbance::damage && trouble) {
        can::Frame broken = bench.rig.pressure(0.0F);
        broken.data[0] ^= 0xFFU;
        bench.rig_end.send(broken);
        bench.rig_end.send({.id = 0x123, .length = 3, .data = {}, .received = {}});
    }
    if (bench.setup.layout[can::Role::sync].bound) bench.rig_sync();
    rig.advance(static_cast<double>(bench.rig.controller().current_mA), 1e-3);
}

}  // namespace

TEST_CASE("the loop does nothing forbidden", "[RT-050]") {
    const auto source = GENERATE(ClockSource::sensors, ClockSource::timer, ClockSource::sync);
    const auto law = GENERATE(control::Law::wheel_slip, control::Law::deceleration, control::Law::open_loop, control::Law::threshold,
                              control::Law::pressure_bias, control::Law::peak_slip);
    const auto disturbance = GENERATE(Disturbance::none, Disturbance::link_lost, Disturbance::silence, Disturbance::damage, Disturbance::overruns);
    LoopBench bench(source);
    bench.received.reserve(100'000);
    ToyRig rig(bench.setup.control, law);
    const auto before = [&](const int period) { act(bench, rig, disturbance, period); };
    if (source == ClockSource::timer)
        bench.plan_timer(kPeriods, before);
    else if (source == ClockSource::sensors)
        bench.plan_sensors(kPeriods, before);
    else
        bench.plan_sync(kPeriods, before);
    traps::clear();
    {
        const traps::Armed armed;
        bench.session->loop().run(bench.stop);
    }
    INFO("clock " << static_cast<int>(source) << ", law " << static_cast<int>(law) << ", plight " << static_cast<int>(disturbance));
    for (std::size_t call = 0; call < traps::kCalls; ++call) {
        INFO(traps::kNames[call]);
        CHECK(traps::caught(static_cast<Call>(call)) == 0);
    }
    // Without SYNC the controller steps less often than the rig would.
    const bool starved = source == ClockSource::sync && (disturbance == Disturbance::silence || disturbance == Disturbance::link_lost);
    CHECK(bench.statistics().steps >= static_cast<std::uint64_t>(starved ? kPeriods * 9 / 10 : kPeriods));
    const control::FaultSet faults = bench.statistics().faults_seen;
    INFO("faults " << faults.bits());
    switch (disturbance) {
        case Disturbance::none:
            CHECK(faults.empty());
            CHECK(bench.statistics().steps_in_state[static_cast<std::size_t>(control::State::braking)] > 1000);
            break;
        case Disturbance::link_lost:
            CHECK(faults.contains(control::Fault::bus_off));
            break;
        case Disturbance::silence:
            CHECK(faults.contains(control::Fault::wheel_lost));
            break;
        case Disturbance::damage:
            CHECK(bench.session->port().unknown_ids() > 0);
            CHECK(bench.session->port().stats(can::Role::pressure).wrong_crc > 0);
            break;
        case Disturbance::overruns:
            CHECK(faults.contains(control::Fault::overrun) == (source != ClockSource::sync));
            break;
    }
}

TEST_CASE("the traps catch each forbidden call, in the program and in shared libraries", "[RT-050]") {
    std::mutex mutex;
    std::ostringstream sunk;
    spdlog::logger logger("trap", std::make_shared<spdlog::sinks::ostream_sink_mt>(sunk));
    const auto count = [](const Call call, const auto& forbidden) {
        traps::clear();
        {
            const traps::Armed armed;
            forbidden();
        }
        return traps::caught(call);
    };
    CHECK(count(Call::allocate, [] { const auto p = std::make_unique<volatile int>(1); }) == 1);
    CHECK(count(Call::release, [] { const auto p = std::make_unique<volatile int>(1); }) == 1);
    CHECK(count(Call::allocate, [] {
              std::string text(100, 'x');
              volatile char& used = text.front();  // clang leaves out what nobody uses
              used = 'y';
          }) == 1);
    CHECK(count(Call::lock, [&] { const std::lock_guard lock(mutex); }) == 1);
    CHECK(count(Call::lock, [&] { logger.info("a locked sink"); }) >= 1);
    CHECK(count(Call::allocate, [&] { logger.info("{:>500}", "longer than the buffer on the stack"); }) >= 1);
    CHECK(count(Call::print, [] { std::printf("%s%s", "", ""); }) == 1);
    CHECK(count(Call::print, [] { std::puts("more than one character"); }) == 1);  // putchar otherwise
    CHECK(count(Call::sleep, [] { std::this_thread::sleep_for(1ns); }) >= 1);
    CHECK(count(Call::throw_exception, [] {
              try {
                  throw std::runtime_error("thrown");
              } catch (const std::runtime_error&) {
              }
          }) == 1);
    CHECK(count(Call::allocate, [] {
              const traps::Disarmed disarmed;
              const auto p = std::make_unique<volatile int>(1);
          }) == 0);
    CHECK(traps::caught() == 0);
}

TEST_CASE("an allocation in the real loop is caught", "[RT-050]") {
    LoopBench bench(ClockSource::timer);
    bench.received.reserve(10'000);
    std::unique_ptr<int> leak;
    bench.plan_timer(100, [&](const int period) {
        if (period == 50) leak = std::make_unique<int>(period);  // as if the loop had done it: not disarmed
        const traps::Disarmed disarmed;
        bench.rig_period(at_rest());
    });
    traps::clear();
    {
        const traps::Armed armed;
        bench.session->loop().run(bench.stop);
    }
    CHECK(traps::caught(Call::allocate) == 1);
}
