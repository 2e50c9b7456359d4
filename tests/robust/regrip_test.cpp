/// Friction courses made up so that one knows when the wheel has the new surface's friction.
#include "plant_sim/study/robust/regrip.hpp"

#include <cmath>
#include <functional>

#include "tests/catch.hpp"

using robust::Regrip;
using robust::RegripMeter;

namespace {

constexpr double kPeriod_s = 1e-3;
const rig::Surface kDry{.name = "dry", .c1 = 1.2801, .c2 = 23.99, .c3 = 0.52};
const rig::Surface kSnow{.name = "snow", .c1 = 0.1946, .c2 = 94.129, .c3 = 0.0646};

/// 0.2 s of dry runway at its peak, then snow, of whose friction `share` is had so long after the change. The aircraft keeps `v_mps`.
std::optional<Regrip> after_change(const std::function<double(double since_s)>& share, double looked_at_s = 3.0, double v_mps = 40.0) {
    RegripMeter meter(kPeriod_s);
    for (int i = 0; i < 200; ++i) meter.update(kDry, v_mps, rig::peak(kDry).mu);
    const int periods = static_cast<int>(std::lround(looked_at_s / kPeriod_s));
    for (int i = 1; i <= periods; ++i) meter.update(kSnow, v_mps, share(i * kPeriod_s) * rig::peak(kSnow).mu);
    return meter.regrip();
}

}  // namespace

TEST_CASE("friction that comes at once, in a step or along a ramp is had when it is", "[STUDY-602]") {
    const auto at_once = after_change([](double) { return 1.0; });
    REQUIRE(at_once);
    CHECK(at_once->measured());
    CHECK(at_once->speed_mps == 40.0);
    CHECK(at_once->judged_s == Approx(2.0));
    CHECK(at_once->regained_s == Approx(kPeriod_s));

    const auto step = after_change([](double t) { return t < 0.3125 ? 0.4 : 0.98; });
    CHECK(step->regained_s == Approx(0.313));
    // 95 % at 0.38 s, all of it at 0.4 s.
    const auto ramp = after_change([](double t) { return std::min(t / 0.4, 1.0); });
    CHECK(*ramp->regained_s == Approx(0.380).margin(1.1e-3));
}

TEST_CASE("friction that is had in passing, or lost again, does not count", "[STUDY-602]") {
    // Through the peak on the way to a lock, back 0.35 s later.
    const auto passed = after_change([](double t) { return t < 0.0295 || t > 0.4005 ? 1.0 : 0.7; });
    CHECK(passed->regained_s == Approx(0.401));
    const auto late_loss = after_change([](double t) { return t > 1.0005 && t < 1.1995 ? 0.8 : 1.0; });
    CHECK(late_loss->regained_s == Approx(1.2));
    const auto never = after_change([](double) { return 0.949; });
    CHECK(never->measured());
    CHECK_FALSE(never->regained_s);
    const auto lost_at_last = after_change([](double t) { return t < 1.95 ? 1.0 : 0.0; });
    CHECK_FALSE(lost_at_last->regained_s);
}

TEST_CASE("a reference that swings counts by its mean: one window of too little is too little", "[STUDY-602]") {
    // 8 Hz. Its mean over 0.1 s swings by a fifth of the amplitude: sin(pi 0.8) / (pi 0.8) = 0.234.
    const auto swing = [](double mean) { return [mean](double t) { return t < 0.25 ? 0.5 : mean + 0.03 * std::sin(50.265482 * t); }; };
    const auto enough = after_change(swing(0.965));
    REQUIRE(enough->regained_s);
    CHECK(*enough->regained_s >= 0.25);
    CHECK(*enough->regained_s <= 0.25 + 0.125);
    // Windows fall below again and again: at best it is kept from the last of them on.
    CHECK(after_change(swing(0.955))->regained_s.value_or(2.0) > 1.7);
}

TEST_CASE("what was looked at too briefly, too slowly or not at all is not measured", "[STUDY-602]") {
    const auto perfect = [](double) { return 1.0; };
    CHECK_FALSE(after_change(perfect, 0.0));
    CHECK_FALSE(after_change(perfect, 0.499)->measured());
    CHECK(after_change(perfect, 0.5)->measured());
    CHECK_FALSE(after_change(perfect, 3.0, 17.9));

    // The next change ends it, though the friction is lost then; and so does the speed.
    RegripMeter patched(kPeriod_s), slow(kPeriod_s);
    for (int i = 0; i < 3000; ++i) {
        const bool snow = i >= 100 && i < 700;
        patched.update(snow ? kSnow : kDry, 40.0, snow ? rig::peak(kSnow).mu : 0.0);
        slow.update(i < 100 ? kDry : kSnow, 30.0 - 0.02 * i, rig::peak(kSnow).mu);
    }
    CHECK(patched.regrip()->judged_s == Approx(0.6));
    CHECK(patched.regrip()->regained_s == Approx(kPeriod_s));
    CHECK(slow.regrip()->judged_s == Approx(0.501).margin(1.5e-3));
    CHECK(slow.regrip()->speed_mps == Approx(28.0));
}
