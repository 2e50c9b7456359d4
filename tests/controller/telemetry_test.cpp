#include "firmware/controller/telemetry.hpp"

#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <sstream>

#include "firmware/can/names.hpp"
#include "tests/catch.hpp"

using namespace std::chrono_literals;
using namespace antiskid;
using control::Fault;
using control::State;

namespace {

struct Log {
    Log() { logger.set_pattern("%l: %v"); }
    std::string take() {
        std::string text = stream.str();
        stream.str("");
        return text;
    }
    std::ostringstream stream;
    spdlog::logger logger{"test", std::make_shared<spdlog::sinks::ostream_sink_st>(stream)};
    std::unique_ptr<host::CycleRing> ring = std::make_unique<host::CycleRing>();
    controller::Telemetry telemetry{logger, "vcan0"};
    std::uint64_t step = 0;

    std::string log(host::CycleRecord record) {
        record.step = ++step;
        record.now = step * 1ms;
        ring->push(record);
        telemetry.drain(*ring);
        return take();
    }
};

host::CycleRecord in_state(const State state, const control::FaultSet faults = {}) {
    host::CycleRecord record;
    record.command.state = state;
    record.command.faults = faults;
    return record;
}

}  // namespace

TEST_CASE("changes of state are logged, sameness is not", "[RT-070]") {
    Log log;
    CHECK(log.log(in_state(State::self_test)) == "info: [0.001 s] state self_test\n");
    CHECK(log.log(in_state(State::self_test)).empty());
    CHECK(log.log(in_state(State::braking)) == "info: [0.003 s] state braking\n");
}

TEST_CASE("faults are logged by name when they come and when they go", "[RT-070]") {
    Log log;
    log.log(in_state(State::safe));
    control::FaultSet faults;
    faults.insert(Fault::wheel_lost);
    faults.insert(Fault::heartbeat_lost);
    const std::string came = log.log(in_state(State::safe, faults));
    CHECK_THAT(came, ContainsSubstring("error: [0.002 s] fault wheel_lost"));
    CHECK_THAT(came, ContainsSubstring("error: [0.002 s] fault heartbeat_lost"));
    faults.insert(Fault::overrun);
    const std::string more = log.log(in_state(State::safe, faults));
    CHECK_THAT(more, ContainsSubstring("fault overrun"));
    CHECK_THAT(more, !ContainsSubstring("wheel_lost"));
    CHECK_THAT(log.log(in_state(State::safe)), ContainsSubstring("info: [0.004 s] fault wheel_lost cleared"));
}

TEST_CASE("what comes and goes all the time is said a few times a second, and counted", "[RT-070]") {
    Log log;
    control::FaultSet lost;
    lost.insert(Fault::heartbeat_lost);
    std::string said;
    for (int i = 0; i < 1000; ++i) said += log.log(i % 2 == 0 ? in_state(State::safe, lost) : in_state(State::standby));
    CHECK(std::count(said.begin(), said.end(), '\n') == 9);
    // Something new is said all the same.
    control::FaultSet more = lost;
    more.insert(Fault::wheel_lost);
    CHECK_THAT(log.log(in_state(State::safe, more)), ContainsSubstring("fault wheel_lost"));
    log.telemetry.summarise(*log.ring);
    CHECK_THAT(log.take(), ContainsSubstring("changes are not listed; since the last summary: ") && ContainsSubstring("heartbeat_lost 1001") &&
                               ContainsSubstring("standby 500"));
    // As long as it goes on a second is two lines, however many changes there are.
    for (int second = 0; second < 100; ++second) {
        said.clear();
        for (int i = 0; i < 1000; ++i) {
            host::CycleRecord record = i % 2 == 0 ? in_state(State::safe, lost) : in_state(State::standby);
            record.synchronised = i % 3 != 0;
            record.link.up = i % 5 != 0;
            said += log.log(record);
        }
        if (second > 0) CHECK(said.empty());
        log.telemetry.summarise(*log.ring);
        said = log.take();
        CHECK(std::count(said.begin(), said.end(), '\n') == 2);
    }
    // After a calm one it is news again.
    log.log(in_state(State::standby));
    log.telemetry.summarise(*log.ring);
    log.log(in_state(State::standby));
    log.telemetry.summarise(*log.ring);
    log.take();
    CHECK_THAT(log.log(in_state(State::safe)), ContainsSubstring("state safe"));
}

TEST_CASE("link and SYNC are logged with the interface's name and what mends them", "[RT-070]") {
    Log log;
    host::CycleRecord record;
    log.log(record);
    record.link.up = false;
    CHECK_THAT(log.log(record), ContainsSubstring("error: [0.002 s] vcan0 is down or gone"));
    record.link.bus_off = true;
    CHECK_THAT(log.log(record), ContainsSubstring("ip link set vcan0 type can restart-ms 100"));
    record.link = {};
    CHECK_THAT(log.log(record), ContainsSubstring("vcan0 is up again"));
    record.synchronised = false;
    CHECK_THAT(log.log(record), ContainsSubstring("error: [0.005 s] no SYNC on vcan0"));
    record.synchronised = true;
    CHECK_THAT(log.log(record), ContainsSubstring("SYNC is back on vcan0"));
}

TEST_CASE("the summary counts what came since the last one", "[RT-073]") {
    Log log;
    log.telemetry.summarise(*log.ring);
    CHECK_THAT(log.take(), ContainsSubstring("nothing has come on vcan0 yet"));
    host::CycleRecord record = in_state(State::braking);
    record.command.speed_mps = 43.21F;
    record.command.current_mA = 17.5F;
    record.latency = 250us;
    record.skipped = 2;
    log.log(record);
    record.latency = 100us;
    log.log(record);
    log.telemetry.summarise(*log.ring);
    const std::string line = log.take();
    for (const char* part : {"braking", "43.2 m/s", "17.50 mA", "2 steps", "4 missed", "250 us"}) CHECK_THAT(line, ContainsSubstring(part));
    log.telemetry.summarise(*log.ring);
    CHECK_THAT(log.take(), ContainsSubstring("the loop stands"));
}

TEST_CASE("records that were lost on the way are owned up to", "[RT-073]") {
    Log log;
    for (int i = 0; i < 5000; ++i) log.ring->push(in_state(State::standby));
    log.telemetry.drain(*log.ring);
    log.take();
    log.telemetry.summarise(*log.ring);
    CHECK_THAT(log.take(), ContainsSubstring("904 records were lost"));
}

TEST_CASE("every state and fault has a name of its own", "[RT-070]") {
    control::FaultSet all;
    for (std::uint8_t i = 0; i < control::kFaultCount; ++i) all.insert(static_cast<Fault>(i));
    auto names = can::fault_names(all);
    REQUIRE(names.size() == control::kFaultCount);
    CHECK(names[static_cast<std::size_t>(Fault::heartbeat_lost)] == "heartbeat_lost");
    for (std::uint8_t i = 0; i < control::kStateCount; ++i) names.emplace_back(can::name(static_cast<State>(i)));
    std::sort(names.begin(), names.end());
    CHECK(std::adjacent_find(names.begin(), names.end()) == names.end());
}
