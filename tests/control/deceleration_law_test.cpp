// The deceleration law against a wheel that decelerates in proportion to the pressure.
#include "firmware/control/deceleration_law.hpp"

#include <cmath>

#include "tests/catch.hpp"
#include "tests/control/law_vectors.hpp"

using namespace antiskid::control;
using control_test::balanced;
using control_test::fixed_config;
using control_test::kFull_Pa;
using control_test::kPeriod_s;

namespace {

Estimate decelerating(const float v_mps, const float slip, const float pressure_Pa, const float mps2) {
    Estimate e = balanced(v_mps, slip, pressure_Pa);
    e.omega_dot_radps2 = -mps2 / e.radius_m;
    e.v_dot_mps2 = -mps2;
    return e;
}

/// The next period of a wheel that decelerates like this.
void roll(Estimate& e, const float mps2) {
    e.omega_radps -= mps2 / e.radius_m * kPeriod_s;
    e.omega_dot_radps2 = -mps2 / e.radius_m;
}

DecelerationLaw law() {
    return {fixed_config().deceleration, fixed_config().slip, kPeriod_s};
}

}  // namespace

TEST_CASE("the law takes over without a jump", "[CTL-050]") {
    DecelerationLaw d = law();
    Estimate e = decelerating(50.0F, 0.05F, 6e6F, 4.0F);
    d.start(e);
    roll(e, 4.0F);
    CHECK(d.pressure_Pa(e, 4.0F, kFull_Pa) == Approx(6e6F).epsilon(1e-4));
    // A new reference comes at 10 m/s3: 0.01 m/s2 a period through k_p.
    DecelerationLaw steps = law();
    steps.start(e);
    float before = 6e6F;
    for (int i = 0; i < 50; ++i) {
        roll(e, 4.0F);
        const float now = steps.pressure_Pa(e, 9.0F, kFull_Pa);
        REQUIRE(now > before - 1.0F);
        REQUIRE(now - before < 0.2e6F * 0.01F * 1.05F + 4e6F * 0.5F * kPeriod_s + 1.0F);
        before = now;
    }
}

TEST_CASE("a demand that falls below what the law asks takes its integral along", "[CTL-050]") {
    DecelerationLaw d = law();
    Estimate e = decelerating(50.0F, 0.05F, 6e6F, 4.0F);
    d.start(e);
    roll(e, 4.0F);
    // The wheel decelerates more than it should: the error leads down, the demand even further.
    CHECK(d.pressure_Pa(e, 0.0F, 3e6F) == 3e6F);
    roll(e, 4.0F);
    const float back_Pa = d.pressure_Pa(e, 0.0F, kFull_Pa);
    CHECK(back_Pa < 3e6F);
    CHECK(back_Pa > 2.9e6F);
}

TEST_CASE("from a reading below none the law begins at none", "[CTL-050]") {
    DecelerationLaw d = law();
    Estimate e = decelerating(50.0F, 0.01F, -0.4e6F, 0.0F);
    d.start(e);
    CHECK(d.pressure_Pa(e, 5.0F, kFull_Pa) == 0.0F);
    const float next_Pa = d.pressure_Pa(e, 5.0F, kFull_Pa);
    CHECK(next_Pa > 0.0F);
    CHECK(next_Pa < 0.1e6F);
}

TEST_CASE("the prescribed deceleration is reached and held", "[CTL-050]") {
    // 0.8 m/s2 per MPa behind a first-order lag of 20 ms.
    const float reference = GENERATE(1.0F, 3.24F, 8.0F);
    DecelerationLaw d = law();
    Estimate e = decelerating(55.0F, 0.02F, 0.0F, 0.0F);
    d.start(e);
    double a = 0.0, pressure = 0.0, max = 0.0;
    auto omega = static_cast<double>(e.omega_radps);  // steps of a slow stop are few units in the last place of a float
    for (int i = 0; i < 4000; ++i) {
        pressure = static_cast<double>(d.pressure_Pa(e, reference, kFull_Pa));
        a += (0.8e-6 * pressure - a) * 1e-3 / 20e-3;
        max = std::max(max, a);
        omega -= a / static_cast<double>(e.radius_m) * 1e-3;
        e.omega_radps = static_cast<float>(omega);
    }
    CHECK(a == Approx(static_cast<double>(reference)).epsilon(1e-3));
    CHECK(max < 1.1 * static_cast<double>(reference));
}

TEST_CASE("one noisy reading of the wheel's acceleration at brake-on changes nothing", "[CTL-050]") {
    const float noise = GENERATE(-12.0F, 5.0F, 12.0F);
    Estimate e = decelerating(55.0F, 0.0F, 0.0F, 0.0F);
    DecelerationLaw quiet = law(), noisy = law();
    quiet.start(e);
    Estimate disturbed = e;
    disturbed.omega_dot_radps2 = noise / e.radius_m;
    noisy.start(disturbed);
    for (int i = 0; i < 1000; ++i) {
        roll(e, 2.0F);
        REQUIRE(noisy.pressure_Pa(e, 3.24F, kFull_Pa) == quiet.pressure_Pa(e, 3.24F, kFull_Pa));
    }
}

TEST_CASE("a biased estimate of acceleration does not bias the law: it integrates to the speed lost", "[CTL-050]") {
    // The wheel follows the pressure, 0.8 m/s2 per MPa behind 20 ms; the estimator claims half as much again.
    DecelerationLaw d = law();
    Estimate e = decelerating(55.0F, 0.02F, 0.0F, 0.0F);
    d.start(e);
    double a = 0.0;
    for (int i = 0; i < 4000; ++i) {
        const auto pressure = static_cast<double>(d.pressure_Pa(e, 3.24F, kFull_Pa));
        a += (0.8e-6 * pressure - a) * 1e-3 / 20e-3;
        roll(e, static_cast<float>(a));
        e.omega_dot_radps2 *= 1.5F;
    }
    CHECK(a == Approx(3.24).epsilon(1e-3));
}

TEST_CASE("above half the slip limit the slip law has the last word", "[CTL-050]") {
    DecelerationLaw d = law();
    Estimate grip = decelerating(50.0F, 0.05F, 6e6F, 4.0F);
    d.start(grip);
    // Long gentle braking below the limit must not teach the guard anything.
    for (int i = 0; i < 20'000; ++i) {
        roll(grip, 4.0F);
        static_cast<void>(d.pressure_Pa(grip, 4.0F, kFull_Pa));
    }
    SlipLaw guard(fixed_config().slip, kPeriod_s);
    guard.start(grip);
    bool bites = false;
    const auto both = [&](const float slip) {
        roll(grip, 4.0F);
        Estimate e = decelerating(50.0F, slip, 6e6F, 4.0F);
        e.omega_radps = grip.omega_radps;  // the slip comes from the road, not from a jump of the wheel
        const float given = d.pressure_Pa(e, 15.0F, kFull_Pa);
        const float allowed = guard.pressure_Pa(e, 0.15F, kFull_Pa);
        CAPTURE(slip);
        REQUIRE(given <= allowed);
        bites = bites || (given == allowed && allowed < kFull_Pa);
        return given;
    };
    for (int i = 0; i < 100; ++i) both(0.076F + 0.004F * static_cast<float>(i));
    CHECK(bites);
    CHECK(both(0.95F) == 0.0F);
    // The integral has followed the guard down: nothing is stored for later.
    Estimate back = decelerating(50.0F, 0.02F, 1e6F, 4.0F);
    roll(grip, 4.0F);
    back.omega_radps = grip.omega_radps;
    CHECK(d.pressure_Pa(back, 4.0F, kFull_Pa) < 3e6F);
}

TEST_CASE("far from the slip limit the guard takes nothing away, at any speed", "[CTL-050]") {
    for (const float v : {60.0F, 20.0F, 4.0F}) {
        DecelerationLaw d = law();
        // The road torque as noisy as it is at low speed.
        Estimate e = decelerating(v, 0.02F, 6e6F, 4.0F);
        d.start(e);
        for (int i = 0; i < 2000; ++i) {
            roll(e, 4.0F);
            e.late_balance_Pa = i % 2 == 0 ? 5e6F : 7e6F;
            REQUIRE(d.pressure_Pa(e, 4.0F, kFull_Pa) == Approx(6e6F).epsilon(1e-3));
        }
    }
}

TEST_CASE("the integral does not wind up at either limit", "[CTL-050]") {
    Estimate e = decelerating(50.0F, 0.05F, 3e6F, 2.0F);
    DecelerationLaw d = law();
    d.start(e);
    const auto step = [&](const float reference, const float ceiling_Pa) {
        roll(e, 2.0F);
        return d.pressure_Pa(e, reference, ceiling_Pa);
    };
    SECTION("ceiling") {
        for (int i = 0; i < 5000; ++i) REQUIRE(step(10.0F, 3e6F) <= 3e6F);
        // Reference back at what is measured: within the onset ramp the pressure is back where it was.
        for (int i = 0; i < 900; ++i) static_cast<void>(step(2.0F, 3e6F));
        CHECK(step(2.0F, kFull_Pa) == Approx(3e6F).epsilon(0.05));
    }
    SECTION("no pressure") {
        for (int i = 0; i < 5000; ++i) static_cast<void>(step(0.0F, kFull_Pa));
        CHECK(step(0.0F, kFull_Pa) == 0.0F);
        int ms = 0;
        Estimate coasting = decelerating(50.0F, 0.0F, 0.0F, 0.0F);
        coasting.omega_radps = e.omega_radps;
        while (ms < 1000 && d.pressure_Pa(coasting, 5.0F, kFull_Pa) <= 0.0F) ++ms;
        CHECK(ms < 300);  // the reference passes the filtered measurement, no more
    }
}

TEST_CASE("close to standstill the last pressure is held", "[CTL-050]") {
    DecelerationLaw d = law();
    Estimate e = decelerating(20.0F, 0.05F, 5e6F, 4.0F);
    d.start(e);
    for (int i = 0; i < 100; ++i) {
        roll(e, 4.0F);
        static_cast<void>(d.pressure_Pa(e, 4.0F, kFull_Pa));
    }
    roll(e, 4.0F);
    const float last = d.pressure_Pa(e, 4.0F, kFull_Pa);
    // The guard lets go for the last 5 ms: what is held is the mean, so that the aircraft still stops.
    const Estimate skid = decelerating(20.0F, 0.95F, 5e6F, 4.0F);
    for (int i = 0; i < 5; ++i) CHECK(d.pressure_Pa(skid, 4.0F, kFull_Pa) < 0.5F * last);
    const Estimate slow = decelerating(0.9F, 0.3F, 5e6F, 40.0F);
    for (int i = 0; i < 100; ++i) REQUIRE(d.pressure_Pa(slow, 4.0F, kFull_Pa) == Approx(last).epsilon(0.06));
    CHECK(d.pressure_Pa(slow, 4.0F, 1e6F) == 1e6F);
    // Taken over there with a transducer a little below zero: still no negative request.
    d.start(decelerating(0.9F, 0.0F, -3e4F, 0.0F));
    CHECK(d.pressure_Pa(slow, 4.0F, kFull_Pa) == 0.0F);
}

TEST_CASE("at half the slip limit the guard still rests, above it it acts", "[CTL-050]") {
    const bool above = GENERATE(false, true);
    DecelerationLaw d = law();
    Estimate e = decelerating(50.0F, 0.05F, 6e6F, 4.0F);
    d.start(e);
    roll(e, 4.0F);
    e.late_balance_Pa = 0.0F;  // ice: the slip law would ask for next to nothing
    e.late_slip = above ? std::nextafter(0.5F * 0.15F, 1.0F) : 0.5F * 0.15F;
    CHECK((d.pressure_Pa(e, 4.0F, kFull_Pa) < 3e6F) == above);
}

TEST_CASE("at the drop-out speed itself the law still acts", "[CTL-050]") {
    const bool below = GENERATE(false, true);
    DecelerationLaw d = law();
    Estimate e = decelerating(20.0F, 0.02F, 2e6F, 0.0F);
    d.start(e);
    e.v_mps = below ? std::nextafter(1.0F, 0.0F) : 1.0F;
    for (int i = 0; i < 200; ++i) static_cast<void>(d.pressure_Pa(e, 5.0F, kFull_Pa));
    CHECK((d.pressure_Pa(e, 5.0F, kFull_Pa) == 2e6F) == below);
}

TEST_CASE("under the ceiling the integral stops where the request reaches it", "[CTL-050]") {
    // The reference rises by 0.9 m/s2 at 10 m/s3 over what the wheel does. The request, I + k_p e, meets the ceiling of 3 MPa after t with
    // 2.9 + 20 t^2 + 2 t = 3 (MPa, k_i / 2 = 20 per s2): 36.6 ms, the integral at 2.927 MPa.
    DecelerationLaw d = law();
    Estimate e = decelerating(50.0F, 0.02F, 2.9e6F, 4.0F);
    d.start(e);
    for (int i = 0; i < 1000; ++i) {
        roll(e, 4.0F);
        REQUIRE(d.pressure_Pa(e, 4.9F, 3e6F) <= 3e6F);
    }
    roll(e, 4.0F);
    CHECK(d.pressure_Pa(e, 4.9F, kFull_Pa) == Approx(2.927e6 + 0.9 * 0.2e6).epsilon(3e-3));
}
