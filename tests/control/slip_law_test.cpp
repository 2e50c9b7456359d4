// The slip law term by term, and what it must not do at its limits.
#include "firmware/control/slip_law.hpp"

#include <cmath>

#include "tests/catch.hpp"
#include "tests/control/law_vectors.hpp"

using namespace antiskid::control;
using control_test::balanced;
using control_test::fixed_config;
using control_test::kPeriod_s;
using control_test::rate_per_Pa;

namespace {

constexpr float kCeiling_Pa = 20.7e6F;
constexpr float kBalance_Pa = 8e6F;

/// A law past its build-up, its reference at `slip`, its integral at zero.
SlipLaw settled(const SlipConfig& config, const float slip, const float v_mps = 40.0F) {
    SlipLaw law(config, kPeriod_s);
    const Estimate e = balanced(v_mps, slip, kBalance_Pa);
    law.start(e);
    static_cast<void>(law.pressure_Pa(e, slip, kCeiling_Pa));
    return law;
}

SlipConfig exact_law() {
    SlipConfig c = fixed_config().slip;
    c.low_speed_mps = 0.0F;
    return c;
}

}  // namespace

TEST_CASE("in balance at the reference the law asks for the balance", "[CTL-040]") {
    const float v = GENERATE(10.0F, 40.0F, 60.0F);
    SlipLaw law = settled(exact_law(), 0.2F, v);
    for (int i = 0; i < 1000; ++i)
        REQUIRE(law.pressure_Pa(balanced(v, 0.2F, kBalance_Pa), 0.2F, kCeiling_Pa) ==
                Approx(kBalance_Pa).epsilon(1e-6));
}

TEST_CASE("each term is worth its gain, scheduled with speed", "[CTL-040]") {
    const float v = GENERATE(6.0F, 20.0F, 60.0F);
    const SlipConfig config = exact_law();
    SlipLaw law = settled(config, 0.2F, v);
    Estimate e = balanced(v, 0.2F, kBalance_Pa);
    const double per_Pa = rate_per_Pa(e);
    const auto asked = [&] {
        SlipLaw copy = law;
        return static_cast<double>(copy.pressure_Pa(e, 0.2F, 1e12F));
    };
    const double base = 8e6;
    SECTION("proportional") {
        e.late_slip = 0.19F;
        CHECK(asked() - base == Approx(45.0 * 0.01 / per_Pa).epsilon(1e-3));
        e.late_slip = 0.21F;
        CHECK(asked() - base == Approx(-45.0 * 0.01 / per_Pa).epsilon(1e-3));
    }
    SECTION("derivative: the slip rate that pressure and road torque make") {
        e.late_pressure.pressure_Pa = 9e6F;
        CHECK(asked() - base == Approx(-2.7 * 1e6).epsilon(1e-3));
    }
    SECTION("second derivative") {
        e.late_pressure.rate_Paps = 1e8F;
        CHECK(asked() - base == Approx(-0.0018 * 1e8).epsilon(1e-3));
    }
    SECTION("feed-forward of the road torque, and its share of the derivative") {
        e.balance_Pa = 7e6F;
        CHECK(asked() == Approx(7e6 - 2.7 * 1e6).epsilon(1e-4));
    }
    SECTION("integral") {
        e.late_slip = 0.19F;
        for (int i = 0; i < 500; ++i) static_cast<void>(law.pressure_Pa(e, 0.2F, 1e12F));
        e.late_slip = 0.2F;
        CHECK(asked() - base == Approx(13.0 * 0.01 * 0.5 / per_Pa).epsilon(2e-3));
    }
}

TEST_CASE("without feed-forward the law is a plain PID", "[CTL-040]") {
    SlipConfig config = exact_law();
    config.road_torque_share = 0.0F;
    SlipLaw law = settled(config, 0.2F);
    CHECK(law.pressure_Pa(balanced(40.0F, 0.2F, kBalance_Pa), 0.2F, kCeiling_Pa) ==
          Approx(0.0F).margin(10.0));
}

TEST_CASE("the integral does not wind up at the ceiling", "[CTL-041]") {
    SlipLaw law = settled(exact_law(), 0.2F);
    const SlipLaw fresh = law;
    // The demand holds the pressure at 3 MPa, the wheel hardly slips: for 5 s the law wants more than it may have.
    Estimate held = balanced(40.0F, 0.03F, 3e6F);
    for (int i = 0; i < 5000; ++i) REQUIRE(law.pressure_Pa(held, 0.2F, 3e6F) == 3e6F);
    SlipLaw after = law;
    SlipLaw never = fresh;
    const Estimate e = balanced(40.0F, 0.2F, kBalance_Pa);
    CHECK(after.pressure_Pa(e, 0.2F, kCeiling_Pa) == never.pressure_Pa(e, 0.2F, kCeiling_Pa));
}

TEST_CASE("the integral does not wind up at no pressure", "[CTL-041]") {
    SlipLaw law = settled(exact_law(), 0.2F);
    SlipLaw never = law;
    Estimate skid = balanced(40.0F, 0.9F, 0.5e6F);
    for (int i = 0; i < 5000; ++i) REQUIRE(law.pressure_Pa(skid, 0.2F, kCeiling_Pa) == 0.0F);
    const Estimate e = balanced(40.0F, 0.2F, kBalance_Pa);
    CHECK(law.pressure_Pa(e, 0.2F, kCeiling_Pa) == never.pressure_Pa(e, 0.2F, kCeiling_Pa));
}

TEST_CASE("at a limit the integral still moves inwards", "[CTL-041]") {
    // Wound up on purpose, then held at the ceiling with the error reversed: it must come back.
    SlipConfig config = exact_law();
    SlipLaw law = settled(config, 0.2F);
    Estimate e = balanced(40.0F, 0.19F, kBalance_Pa);
    for (int i = 0; i < 20'000; ++i) static_cast<void>(law.pressure_Pa(e, 0.2F, 1e12F));
    e.late_slip = 0.2001F;
    const float wound = law.pressure_Pa(e, 0.2F, 1e12F);
    REQUIRE(wound > kBalance_Pa + 1e4F);
    for (int i = 0; i < 20'000; ++i) static_cast<void>(law.pressure_Pa(e, 0.2F, kBalance_Pa));
    CHECK(law.pressure_Pa(e, 0.2F, 1e12F) < wound - 100.0F);
}

TEST_CASE("a change of set-point moves the request at a limited rate", "[CTL-042]") {
    const SlipConfig config = exact_law();
    SlipLaw law = settled(config, 0.1F);
    const Estimate e = balanced(40.0F, 0.1F, kBalance_Pa);
    float before = law.pressure_Pa(e, 0.1F, kCeiling_Pa);
    // One period of reference rate through the proportional gain, and the little that the integral adds.
    const double most = 45.0 * 50.0 * 1e-3 / rate_per_Pa(e) * 1.02;
    for (const float set_point : {0.24F, 0.05F, 0.5F, 0.0F}) {
        for (int i = 0; i < 20; ++i) {
            const float now = law.pressure_Pa(e, set_point, 1e12F);
            if (now > 0.0F && before > 0.0F) {
                REQUIRE(std::abs(static_cast<double>(now - before)) <= most);
            }
            before = now;
        }
        CHECK(law.reference() == Approx(set_point).margin(1e-6));
    }
}

TEST_CASE("a demand that falls and rises again changes nothing but the ceiling", "[CTL-043]") {
    SlipLaw law = settled(exact_law(), 0.2F);
    SlipLaw undisturbed = law;
    const Estimate e = balanced(40.0F, 0.2F, kBalance_Pa);
    for (int i = 0; i < 300; ++i) {
        // A triangle from full demand to none and back; the wheel itself is held where it is.
        const float share = std::abs(static_cast<float>(i) - 150.0F) / 150.0F;
        const float ceiling = kCeiling_Pa * share;
        const float given = law.pressure_Pa(e, 0.2F, ceiling);
        REQUIRE(given <= ceiling);
        REQUIRE(given == Approx(std::min(ceiling, kBalance_Pa)).epsilon(1e-6));
    }
    for (int i = 0; i < 300; ++i) static_cast<void>(undisturbed.pressure_Pa(e, 0.2F, kCeiling_Pa));
    CHECK(law.pressure_Pa(e, 0.2F, kCeiling_Pa) ==
          Approx(undisturbed.pressure_Pa(e, 0.2F, kCeiling_Pa)).epsilon(1e-6));
}

TEST_CASE("below the low speed the reference falls with speed", "[CTL-044]") {
    const SlipConfig config = fixed_config().slip;  // 24 m/s, floor 8 m/s, slip 0.14
    const auto in_force = [&config](const float v, const float reference) {
        SlipLaw law = settled(config, reference, v);
        for (int i = 0; i < 100; ++i)
            static_cast<void>(law.pressure_Pa(balanced(v, reference, kBalance_Pa), reference, kCeiling_Pa));
        return law.reference();
    };
    CHECK(in_force(60.0F, 0.24F) == Approx(0.24F));
    CHECK(in_force(24.0F, 0.24F) == Approx(0.24F));
    CHECK(in_force(16.0F, 0.24F) == Approx(0.19F).epsilon(1e-4));
    CHECK(in_force(12.0F, 0.24F) == Approx(0.165F).epsilon(1e-4));
    CHECK(in_force(8.0F, 0.24F) == Approx(0.14F));
    CHECK(in_force(5.0F, 0.24F) == Approx(0.14F));
    // A lower set-point is never raised.
    for (const float v : {60.0F, 16.0F, 5.0F}) CHECK(in_force(v, 0.10F) == Approx(0.10F));
}

TEST_CASE("low_speed_mps = 0 is the paper's exact law at every speed", "[CTL-044]") {
    for (const float v : {60.0F, 16.0F, 5.0F, 0.5F}) {
        SlipLaw law = settled(exact_law(), 0.24F, v);
        for (int i = 0; i < 100; ++i)
            static_cast<void>(law.pressure_Pa(balanced(v, 0.24F, kBalance_Pa), 0.24F, kCeiling_Pa));
        CHECK(law.reference() == Approx(0.24F));
    }
}

TEST_CASE("at brake-on the pressure is built up until the slip is there, once", "[CTL-045]") {
    const SlipConfig config =
        exact_law();  // 1 MPa per period up to 10 MPa above the balance, until 90 % of the reference
    SlipLaw law(config, kPeriod_s);
    Estimate e = balanced(60.0F, 0.0F, 0.0F);
    law.start(e);
    CHECK(law.reference() == 0.0F);
    float ramp = 0.0F;
    for (int i = 0; i < 30; ++i) {
        e.late_slip = 0.004F * static_cast<float>(i);
        SlipLaw plain = law;
        const float given = law.pressure_Pa(e, 0.24F, kCeiling_Pa);
        ramp = std::min(ramp + 1e6F, 10e6F);
        CAPTURE(i);
        REQUIRE(given >= e.balance_Pa + ramp - 1.0F);
        REQUIRE(plain.pressure_Pa(e, 0.24F, 4e6F) <= 4e6F);  // the demand is the ceiling of the build-up too
    }
    e.late_slip = 0.22F;  // above 0.216
    e.balance_Pa = 6e6F;
    e.late_pressure.pressure_Pa = 6e6F;
    const double p = 6e6 + 45.0 * 0.02 / rate_per_Pa(e);
    CHECK(law.pressure_Pa(e, 0.24F, kCeiling_Pa) == Approx(p).epsilon(1e-4));  // the integral has rested
    e.late_slip = 0.10F;
    const double q = 6e6 + (45.0 * 0.14 + 13.0 * 0.02 * 1e-3) / rate_per_Pa(e);
    CHECK(law.pressure_Pa(e, 0.24F, 1e12F) == Approx(q).epsilon(1e-3));  // and the build-up is over for good
}

TEST_CASE("towards a reference far past the peak the build-up ends early", "[CTL-180]") {
    // At 90 % of the limit, whatever is asked for beyond it; then the gains bring the rest.
    SlipConfig config = exact_law();
    const float limit = GENERATE(0.2F, 0.3F);
    config.build_up_reference_limit = limit;
    const float reference = GENERATE(0.3F, 0.4F, 0.5F);
    SlipLaw law(config, kPeriod_s);
    Estimate e = balanced(60.0F, 0.0F, kBalance_Pa);
    law.start(e);
    // The reference is there after 10 periods, and with it 10 MPa of build-up; the demand has no say.
    for (int i = 0; i < 20; ++i) static_cast<void>(law.pressure_Pa(e, reference, 1e12F));
    e.late_slip = 0.9F * limit - 0.01F;
    CHECK(law.pressure_Pa(e, reference, 1e12F) == Approx(kBalance_Pa + 10e6F));
    e.late_slip = 0.9F * limit + 0.01F;
    const double by_gains_Pa = 8e6 + 45.0 * static_cast<double>(reference - e.late_slip) / rate_per_Pa(e);
    CHECK(law.pressure_Pa(e, reference, 1e12F) == Approx(by_gains_Pa).epsilon(1e-4));
}

TEST_CASE("the law takes over at the slip that it finds", "[CTL-045]") {
    SlipLaw law(exact_law(), kPeriod_s);
    law.start(balanced(40.0F, 0.35F, kBalance_Pa));
    CHECK(law.reference() == 0.35F);
    law.start(balanced(40.0F, -0.2F, kBalance_Pa));
    CHECK(law.reference() == 0.0F);
}

TEST_CASE("the build-up ends at its share of the reference, not after it", "[CTL-045]") {
    SlipConfig config = exact_law();
    config.build_up_slip = 0.5F;
    SlipLaw law(config, kPeriod_s);
    Estimate e = balanced(60.0F, 0.0F, kBalance_Pa);
    law.start(e);
    for (int i = 0; i < 20; ++i) static_cast<void>(law.pressure_Pa(e, 0.25F, 1e12F));
    REQUIRE(law.reference() == 0.25F);
    e.late_slip = std::nextafter(0.125F, 0.0F);
    CHECK(law.pressure_Pa(e, 0.25F, 1e12F) == Approx(kBalance_Pa + 10e6F));
    e.late_slip = 0.125F;
    CHECK(law.pressure_Pa(e, 0.25F, 1e12F) == Approx(8e6 + 45.0 * 0.125 / rate_per_Pa(e)).epsilon(1e-4));
}
