// The search for the slip of most friction: what it measures, how it moves, and where it must not go.
#include "firmware/control/peak_seeker.hpp"

#include <algorithm>

#include "tests/catch.hpp"
#include "tests/control/law_vectors.hpp"

using namespace antiskid::control;
using control_test::balanced;
using control_test::fixed_config;
using control_test::kPeriod_s;

namespace {

constexpr float kInertia_kgm2 = 1.3F;

/// A wheel at 40 m/s and this slip, on a road whose friction has this elasticity over slip.
Estimate on_road(const float elasticity, const float slip = 0.2F, const float road_radps2 = 4000.0F) {
    Estimate e = balanced(40.0F, slip, 8e6F);
    e.road_radps2 = road_radps2;
    e.wheel_pole_radps = elasticity * e.radius_m * road_radps2 / (slip * e.v_mps);
    return e;
}

PeakConfig without_swing() {
    PeakConfig c = fixed_config().peak;
    c.swing = 0.0F;
    return c;
}

PeakSeeker after(const int periods, const Estimate& e, const PeakConfig& config = without_swing()) {
    PeakSeeker seeker(config, kInertia_kgm2, kPeriod_s);
    for (int i = 0; i < periods; ++i) static_cast<void>(seeker.reference(e));
    return seeker;
}

/// By what factor one more period moves it, its filter settled.
double growth(const Estimate& e, const PeakConfig& config = without_swing()) {
    PeakSeeker seeker = after(400, e, config);
    seeker.forget_runway();
    const float before = seeker.found().peak_slip;
    static_cast<void>(seeker.reference(e));
    return static_cast<double>(seeker.found().peak_slip / before);
}

}  // namespace

TEST_CASE("the elasticity of friction is measured without load, inertia or speed", "[CTL-340]") {
    for (const float elasticity : {-0.3F, 0.0F, 0.4F}) {
        CHECK(after(400, on_road(elasticity)).elasticity() == Approx(elasticity).margin(1e-5));
        CHECK(after(400, on_road(elasticity, 0.05F)).elasticity() == Approx(elasticity).margin(1e-5));
        CHECK(after(400, on_road(elasticity, 0.2F, 400.0F)).elasticity() == Approx(elasticity).margin(1e-5));
        Estimate slow = on_road(elasticity);
        slow.v_mps = 10.0F;
        slow.wheel_pole_radps *= 4.0F;  // wheel_observer.hpp: a goes with 1 / v
        CHECK(after(400, slow).elasticity() == Approx(elasticity).margin(1e-5));
    }
    // A first-order filter: 1 - (1 - 0.05)^20 of a step after 20 ms.
    CHECK(after(20, on_road(0.4F)).elasticity() == Approx(0.4 * 0.641514).epsilon(1e-4));
}

TEST_CASE("what cannot be is bounded before it is believed", "[CTL-340]") {
    Estimate e = on_road(0.0F);
    e.wheel_pole_radps = 6000.0F;
    CHECK(after(400, e).elasticity() == Approx(1.0));
    e.wheel_pole_radps = -6000.0F;
    CHECK(after(400, e).elasticity() == Approx(-1.0));
    e.wheel_pole_radps = 1.0F;
    e.slip = -0.3F;  // counts as 0.01, no road torque as 50 rad/s2
    e.road_radps2 = -100.0F;
    CHECK(after(400, e).elasticity() == Approx(0.01 * 40.0 / (0.32 * 50.0)).epsilon(1e-4));
}

TEST_CASE("grip is the road's force, taken in as far as friction does not change with slip", "[CTL-340]") {
    // J tau / r = 1.3 * 4000 / 0.32
    CHECK(after(400, on_road(0.0F)).found().grip_N == Approx(16250.0).epsilon(1e-4));
    CHECK(after(400, on_road(0.0F, 0.2F, 400.0F)).found().grip_N == Approx(1625.0).epsilon(1e-4));
    // A first-order filter, its bandwidth falling with the elasticity: hardly anything where friction rises as slip does.
    CHECK(after(20, on_road(0.0F)).found().grip_N == Approx(16250.0 * 0.641514).epsilon(1e-4));
    Estimate steep = on_road(1.0F);
    PeakSeeker seeker = after(400, steep);
    const float before = seeker.found().grip_N;
    steep.road_radps2 *= 2.0F;
    steep.wheel_pole_radps *= 2.0F;
    for (int i = 0; i < 400; ++i) static_cast<void>(seeker.reference(steep));
    CHECK(seeker.found().grip_N == Approx(before).epsilon(1e-4));
    seeker.forget_runway();
    CHECK(seeker.found().grip_N == 0.0F);
}

TEST_CASE("confidence needs a slip at the peak and a slope that is known", "[CTL-340]") {
    CHECK(after(400, on_road(0.0F)).found().confidence == Approx(1.0).epsilon(1e-4));
    CHECK(after(400, on_road(0.4F)).found().confidence == Approx(0.6).epsilon(1e-3));
    CHECK(after(400, on_road(-0.4F)).found().confidence == Approx(0.6).epsilon(1e-3));
    Estimate unsure = on_road(0.0F);
    // A standard deviation of the elasticity of 0.5: 1 / (1 + 0.25).
    const float per_elasticity = unsure.radius_m * unsure.road_radps2 / (unsure.slip * unsure.v_mps);
    unsure.wheel_pole_variance_radps2 = 0.25F * per_elasticity * per_elasticity;
    PeakSeeker seeker = after(400, unsure);
    CHECK(seeker.found().confidence == Approx(0.8).epsilon(1e-3));
    seeker.forget_runway();
    CHECK(seeker.found().confidence == 0.0F);
}

TEST_CASE("the reference moves by what is missing of the elasticity asked for", "[CTL-340]") {
    CHECK(growth(on_road(0.1F)) == Approx(1.0 + 4.0 * 2.0 * 0.1e-3).epsilon(1e-6));
    CHECK(growth(on_road(-0.1F)) == Approx(1.0 - 4.0 * 2.0 * 0.1e-3).epsilon(1e-6));
    CHECK(growth(on_road(0.0F)) == 1.0);
    CHECK(growth(on_road(0.9F)) == Approx(1.004).epsilon(1e-6));  // the whole rate
    CHECK(growth(on_road(-0.9F)) == Approx(0.996).epsilon(1e-6));
    PeakConfig before_peak = without_swing();
    before_peak.elasticity = 0.1F;
    CHECK(growth(on_road(0.1F), before_peak) == Approx(1.0).margin(1e-6));
    CHECK(growth(on_road(0.0F), before_peak) == Approx(1.0 - 0.8e-3).epsilon(1e-6));
}

TEST_CASE("it begins at its start, and stays between its ends", "[CTL-340]") {
    CHECK(PeakSeeker(without_swing(), kInertia_kgm2, kPeriod_s).found().peak_slip == 0.16F);
    CHECK(after(3000, on_road(0.9F)).found().peak_slip == 0.4F);
    CHECK(after(3000, on_road(-0.9F)).found().peak_slip == 0.03F);
}

TEST_CASE("the reference swings about what was found", "[CTL-340]") {
    PeakConfig config = fixed_config().peak;  // a quarter of itself at 5 Hz
    PeakSeeker seeker(config, kInertia_kgm2, kPeriod_s);
    const Estimate e = on_road(0.0F);
    float reference[200];
    double sum = 0.0;
    for (float& one : reference) sum += static_cast<double>(one = seeker.reference(e));
    CHECK(seeker.found().peak_slip == 0.16F);
    CHECK(sum / 200.0 == Approx(0.16).epsilon(1e-3));
    CHECK(reference[24] == Approx(0.16 * 1.125).epsilon(1e-3));
    CHECK(reference[49] == Approx(0.16 * 1.25).epsilon(1e-3));
    CHECK(reference[99] == Approx(0.16).epsilon(1e-3));
    CHECK(reference[149] == Approx(0.16 * 0.75).epsilon(1e-3));
    CHECK(reference[174] == Approx(0.16 * 0.875).epsilon(1e-3));
    for (const float one : reference) CHECK(seeker.reference(e) == Approx(one).epsilon(1e-4));
    SECTION("not above the most that it may be") {
        float max = 0.0F;
        for (int i = 0; i < 3000; ++i) max = std::max(max, seeker.reference(on_road(0.9F)));
        CHECK(max == 0.4F);
    }
}

TEST_CASE("on another road it begins at its start, if less was in force", "[CTL-340]") {
    for (const float before : {-0.9F, 0.9F}) {
        PeakSeeker seeker = after(3000, on_road(before));
        const float was = seeker.found().peak_slip;
        Estimate e = on_road(0.0F);
        e.another_road = true;
        static_cast<void>(seeker.reference(e));
        CHECK(seeker.elasticity() == 0.0F);
        CHECK(seeker.found().peak_slip == std::max(was, 0.16F));
    }
}

TEST_CASE("a wheel that is nearly locked takes the reference down", "[CTL-340]") {
    CHECK(growth(on_road(0.0F, 0.6F)) == 1.0);
    CHECK(growth(on_road(0.0F, 0.61F)) == Approx(1.0 - 10e-3).epsilon(1e-6));
    CHECK(growth(on_road(-0.9F, 0.61F)) == Approx(1.0 - 14e-3).epsilon(1e-6));
}

TEST_CASE("at walking speed nothing is sought", "[CTL-340]") {
    Estimate e = on_road(0.9F);
    e.v_mps = 5.9F;
    CHECK(after(400, e).found().peak_slip == 0.16F);
    CHECK(after(400, e).elasticity() == 0.0F);
    e.v_mps = 6.0F;
    CHECK(after(400, e).found().peak_slip > 0.2F);
}

TEST_CASE("another law leaves what was found, a lock what is not above the start, another landing nothing", "[CTL-340]") {
    PeakSeeker seeker = after(200, on_road(0.5F));
    const float found = seeker.found().peak_slip;
    REQUIRE(found > 0.2F);
    seeker.start(false);
    CHECK(seeker.found().peak_slip == found);
    CHECK(seeker.elasticity() == 0.0F);
    seeker.start(true);
    CHECK(seeker.found().peak_slip == 0.16F);
    seeker = after(400, on_road(-0.5F));
    const float less = seeker.found().peak_slip;
    REQUIRE(less < 0.16F);
    seeker.start(true);
    CHECK(seeker.found().peak_slip == less);
    seeker.forget_runway();
    CHECK(seeker.found().peak_slip == 0.16F);
}
