#include <unistd.h>
#include <csignal>
#include <thread>

#include "firmware/host/stop_signals.hpp"
#include "rig_bridge/bridge/reset_request.hpp"
#include "rig_bridge/bridge/rig_time.hpp"
#include "rig_bridge/bridge/wall_clock.hpp"
#include "tests/catch.hpp"

TEST_CASE("Without SYNC the rig's time is the machine's", "[BRG-400]") {
    rig::bridge::RigTime time(1e-3);
    CHECK(time.at(100.0, 0) == 0.0);
    CHECK(time.at(100.5, 0) == Approx(0.5));
    CHECK(time.at(103.0, 0) == Approx(3.0));
}

TEST_CASE("With SYNC it counts periods, and the machine's clock again where they end", "[BRG-400]") {
    rig::bridge::RigTime time(1e-3);
    CHECK(time.at(0.0, 7) == 0.0);
    CHECK(time.at(0.01, 17) == Approx(0.010));
    CHECK(time.at(1.0, 18) == Approx(0.011));
    // Silent for less than the patience: time stands; for more: it runs on.
    CHECK(time.at(1.1, 18) == Approx(0.011));
    CHECK(time.at(1.3, 18) == Approx(0.211));
    CHECK(time.at(2.3, 18) == Approx(1.211));
    CHECK(time.at(2.4, 118) == Approx(1.311));
    CHECK(time.at(2.5, 118) == Approx(1.311));
}

TEST_CASE("A reset is asked for by rising edges until it is no longer wanted", "[BRG-400]") {
    rig::bridge::ResetRequest reset;
    int edges = 0;
    bool before = false;
    for (int i = 0; i < 500; ++i) {
        const bool now = reset.step(true, i * 0.01);
        if (i == 0) CHECK_FALSE(now);
        edges += now && !before ? 1 : 0;
        before = now;
    }
    CHECK(edges >= 4);
    CHECK(edges <= 6);
    CHECK_FALSE(reset.step(false, 5.0));
    CHECK_FALSE(reset.step(true, 5.01));
}

TEST_CASE("The first signal and the number of all of them are known", "[BRG-410]") {
    antiskid::host::StopSignals stops;
    CHECK(stops.count() == 0);
    CHECK(stops.number() == 0);
    REQUIRE(kill(getpid(), SIGINT) == 0);
    while (stops.count() == 0) std::this_thread::yield();
    REQUIRE(kill(getpid(), SIGTERM) == 0);
    while (stops.count() == 1) std::this_thread::yield();
    CHECK(stops.count() == 2);
    CHECK(stops.number() == SIGINT);
}

TEST_CASE("Wall clock as ISO 8601", "[BRG-410]") {
    CHECK(rig::bridge::iso_8601(std::chrono::system_clock::time_point(std::chrono::seconds(1'000'000'000))) == "2001-09-09T01:46:40Z");
}
