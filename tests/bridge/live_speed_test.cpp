#include "rig_bridge/bridge/live_speed.hpp"

#include <cmath>
#include <random>

#include "tests/catch.hpp"

using antiskid::control::SpeedInput;
using antiskid::control::Time;

namespace {

constexpr double kTeeth = 60.0;
const double kPitch = 2.0 * std::numbers::pi / kTeeth;

Time at(double s) {
    return Time(std::llround(s * 1e9));
}

/// A shaft of constant speed, as its encoder says it at `t`; a third of a pitch in at t = 0.
SpeedInput shaft(double radps, double t) {
    SpeedInput in;
    in.received = at(t);
    const double edges = std::floor(radps * t / kPitch + 1.0 / 3.0);
    in.edge_count = static_cast<std::uint32_t>(edges) + 4'294'967'000U;  // rolls over
    in.edge_time = at(edges > 0.0 ? (edges - 1.0 / 3.0) * kPitch / radps : 0.0);
    return in;
}

}  // namespace

TEST_CASE("A constant speed is measured exactly, however late its frames are", "[BRG-420]") {
    for (const double radps : {100.0, 30.0, 10.0, 4.0}) {
        CAPTURE(radps);
        rig::bridge::LiveSpeed speed(kTeeth);
        std::mt19937_64 random(1);
        std::uniform_real_distribution<double> late(0.0, 0.025);
        double now = 0.0;
        for (int i = 0; i < 2000; ++i) {
            const double t = i * 1e-3;
            now = std::max(now, t + late(random));
            SpeedInput in = shaft(radps, t);
            in.received = at(now);
            speed.update(in);
            if (t > 1.0) CHECK(speed.radps() == Approx(radps).epsilon(1e-6));
        }
    }
}

TEST_CASE("A shaft that stops is soon seen to stop", "[BRG-420]") {
    rig::bridge::LiveSpeed speed(kTeeth);
    for (int i = 0; i < 1000; ++i) speed.update(shaft(100.0, i * 1e-3));
    SpeedInput last = shaft(100.0, 0.999);
    int ms = 0;
    const auto repeated = [&](double until_s) {
        while (ms < std::lround(1e3 * until_s)) {
            last.received = at(0.999 + 1e-3 * ++ms);
            speed.update(last);
        }
        return speed.radps();
    };
    CHECK(repeated(0.03) == Approx(100.0));
    CHECK(repeated(0.03 + 0.1) < 1.1);
    CHECK(repeated(10.0) < 0.02);
}

TEST_CASE("A machine that reads no frames for a while takes no shaft for slow", "[BRG-420]") {
    rig::bridge::LiveSpeed speed(kTeeth);
    for (int i = 0; i < 1000; ++i) speed.update(shaft(100.0, i * 1e-3));
    speed.update(shaft(100.0, 1.5));
    CHECK(speed.radps() == Approx(100.0));
}

TEST_CASE("Nor does one whose bus stands still, though the first frame after it has no new edge", "[BRG-420]") {
    rig::bridge::LiveSpeed speed(kTeeth);
    double pause_s = 0.0;
    for (int i = 0; i < 3000; ++i) {
        if (i % 10 == 0) pause_s += 0.1;  // the shaft waits for the bus, as in lockstep
        SpeedInput in = shaft(30.0, i * 1e-3);
        in.received = at(i * 1e-3 + pause_s);
        speed.update(in);
        if (i > 1000) CHECK(speed.radps() == Approx(30.0).epsilon(1e-6));
    }
}

TEST_CASE("Nothing is measured before the first frame, and a sensor that starts again starts again", "[BRG-420]") {
    rig::bridge::LiveSpeed speed(kTeeth);
    speed.update(SpeedInput{});
    CHECK(speed.radps() == 0.0);
    for (int i = 0; i < 1000; ++i) speed.update(shaft(100.0, 50.0 + i * 1e-3));
    SpeedInput again;
    again.received = at(1.0);
    speed.update(again);
    CHECK(speed.radps() == 0.0);
    SpeedInput reported;
    reported.received = at(1.0);
    reported.source = antiskid::control::SpeedSource::speed;
    reported.speed_radps = 12.5F;
    speed.update(reported);
    CHECK(speed.radps() == 12.5);
}
