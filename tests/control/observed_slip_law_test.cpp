// The observed slip law term by term, what it must not do at its limits, and when its reference retreats.
#include "firmware/control/observed_slip_law.hpp"

#include <cmath>

#include "tests/catch.hpp"
#include "tests/control/law_vectors.hpp"

using namespace antiskid::control;
using control_test::fixed_config;
using control_test::kPeriod_s;
using control_test::rate_per_Pa;

namespace {

constexpr float kMost_Pa = 20.7e6F;
constexpr float kRoad_Pa = 8e6F;

Estimate at_rest(const float v_mps, const float slip, const float answer_per_s = 0.0F) {
    Estimate e = control_test::balanced(v_mps, slip, kRoad_Pa);
    e.late_balance_Pa = kRoad_Pa;
    e.answer_per_s = answer_per_s;
    return e;
}

SlipConfig exact_fall() {
    SlipConfig c = fixed_config().slip;
    c.low_speed_mps = 0.0F;
    return c;
}

ObservedSlipLaw begun(const float slip, const float v_mps = 40.0F) {
    ObservedSlipLaw law(fixed_config().observer, exact_fall(), kPeriod_s);
    law.start(at_rest(v_mps, slip));
    static_cast<void>(law.pressure_Pa(at_rest(v_mps, slip), slip, kMost_Pa));
    return law;
}

}  // namespace

TEST_CASE("in balance at the reference the observed law asks for the balance", "[CTL-310]") {
    const float v = GENERATE(10.0F, 40.0F, 60.0F);
    ObservedSlipLaw law = begun(0.2F, v);
    for (int i = 0; i < 1000; ++i)
        REQUIRE(law.pressure_Pa(at_rest(v, 0.2F), 0.2F, kMost_Pa) == Approx(kRoad_Pa).epsilon(1e-6));
    CHECK(law.reference() == Approx(0.2));
    CHECK(law.asked() == Approx(0.2));
}

TEST_CASE("each term of the observed law is worth its gain", "[CTL-310]") {
    const float v = GENERATE(6.0F, 20.0F, 60.0F);
    const ObservedSlipLaw law = begun(0.2F, v);
    Estimate e = at_rest(v, 0.2F);
    const double per_Pa = rate_per_Pa(e);
    const auto more = [&] {
        ObservedSlipLaw copy = law;
        return (static_cast<double>(copy.pressure_Pa(e, 0.2F, 1e12F)) - 8e6) * per_Pa;
    };
    SECTION("proportional") {
        e.late_slip = 0.19F;
        CHECK(more() == Approx(100.0 * 0.01).epsilon(1e-3));
    }
    SECTION("with the road's answer, where it restores") {
        e.late_slip = 0.19F;
        e.answer_per_s = 1000.0F;
        CHECK(more() == Approx(400.0 * 0.01).epsilon(1e-3));
        e.answer_per_s = -10.0F;
        CHECK(more() == Approx(100.0 * 0.01).epsilon(1e-3));
    }
    SECTION("slip rate") {
        e.late_pressure.pressure_Pa = kRoad_Pa + 1e5F;
        CHECK(more() == Approx(-4.0 * 1e5 * per_Pa).epsilon(1e-3));
    }
    SECTION("rate of the slip rate") {
        e.late_pressure.rate_Paps = 1e7F;
        CHECK(more() == Approx(-0.005 * 1e7 * per_Pa).epsilon(1e-3));
    }
    SECTION("no more than the largest slip rate") {
        e.late_slip = -0.5F;
        CHECK(more() == Approx(20.0).epsilon(1e-3));
    }
    SECTION("the balance fed forward is that after the delay") {
        e.late_balance_Pa = kRoad_Pa + 2e5F;
        e.late_pressure.pressure_Pa = kRoad_Pa + 2e5F;
        CHECK(more() == Approx(2e5 * per_Pa).epsilon(1e-3));
    }
}

TEST_CASE("the observed law's integral moves inwards only, at both limits", "[CTL-311]") {
    const auto after = [](float late_slip, float ceiling_Pa) {
        ObservedSlipLaw law = begun(0.2F);
        Estimate e = at_rest(40.0F, 0.2F);
        e.late_slip = late_slip;
        for (int i = 0; i < 500; ++i) static_cast<void>(law.pressure_Pa(e, 0.2F, ceiling_Pa));
        return (static_cast<double>(law.pressure_Pa(at_rest(40.0F, 0.2F), 0.2F, 1e12F)) - 8e6) *
               rate_per_Pa(at_rest(40.0F, 0.2F));
    };
    CHECK(after(0.19F, 5e6F) == Approx(0.0).margin(1e-3));     // wants more than it may
    CHECK(after(0.9F, kMost_Pa) == Approx(0.0).margin(1e-3));  // less than nothing
    CHECK(after(0.199F, kMost_Pa) == Approx(200.0 * 0.001 * 0.5).epsilon(0.01));
    CHECK(after(0.201F, kMost_Pa) == Approx(-200.0 * 0.001 * 0.5).epsilon(0.01));
    CHECK(after(0.201F, 5e6F) == Approx(-200.0 * 0.001 * 0.5).epsilon(0.01));  // at the ceiling, downwards
}

TEST_CASE("the reference retreats while the wheel runs away, and comes back", "[CTL-312]") {
    ObservedSlipLaw law = begun(0.2F);
    const auto run = [&](float answer, float slip, int periods) {
        Estimate e = at_rest(40.0F, slip, answer);
        for (int i = 0; i < periods; ++i) static_cast<void>(law.pressure_Pa(e, 0.2F, kMost_Pa));
        return law.reference();
    };
    CHECK(run(-14.0F, 0.2F, 1000) == Approx(0.2));  // held
    // 20 1/s faster than is held: 0.2 * 20 / 30 of the reference a second, once the filter is there.
    const float before = run(-35.0F, 0.2F, 300);
    CHECK(before - run(-35.0F, 0.2F, 1000) == Approx(0.2 * 0.2 * 20.0 / 30.0).epsilon(0.02));
    CHECK(law.asked() == Approx(0.2));
    // Never faster than its rates, and never to nothing.
    const float at = run(-60.0F, 0.2F, 300);
    CHECK(at - run(-60.0F, 0.2F, 100) <= 1.0F * 0.2F * 0.1F + 1e-4F);
    CHECK(run(-60.0F, 0.2F, 10'000) == Approx(0.15 * 0.2));
    const float low = run(500.0F, 0.05F, 200);
    CHECK(run(500.0F, 0.05F, 1000) - low == Approx(0.2 * 0.2).epsilon(0.01));
    CHECK(run(500.0F, 0.05F, 10'000) == Approx(0.2));
}

TEST_CASE("a wheel that nearly locks takes the reference back at once", "[CTL-312]") {
    ObservedSlipLaw law = begun(0.2F);
    Estimate e = at_rest(40.0F, 0.61F, 500.0F);
    for (int i = 0; i < 100; ++i) static_cast<void>(law.pressure_Pa(e, 0.2F, kMost_Pa));
    CHECK(law.reference() == Approx(0.2 * (1.0 - (5.0 - 0.2) * 0.1)).epsilon(0.02));
    e.slip = 0.6F;
    const float there = law.reference();
    static_cast<void>(law.pressure_Pa(e, 0.2F, kMost_Pa));
    CHECK(law.reference() > there);
}

TEST_CASE("the observed law takes over at the slip that it finds, and falls with speed", "[CTL-313]") {
    ObservedSlipLaw law(fixed_config().observer, fixed_config().slip, kPeriod_s);
    law.start(at_rest(40.0F, 0.05F));
    CHECK(law.reference() == Approx(0.05));
    static_cast<void>(law.pressure_Pa(at_rest(40.0F, 0.05F), 0.24F, kMost_Pa));
    CHECK(law.reference() == Approx(0.05 + 50.0 * 1e-3));
    law.start(at_rest(40.0F, -0.02F));
    CHECK(law.reference() == 0.0F);
    for (int i = 0; i < 100; ++i) static_cast<void>(law.pressure_Pa(at_rest(16.0F, 0.19F), 0.24F, kMost_Pa));
    CHECK(law.reference() == Approx(0.19));  // half-way from 24 to 8 m/s: between 0.24 and 0.14
    CHECK(law.asked() == Approx(0.19));
}
