// INCREASE, HOLD and DECREASE: every transition, and the pressure in each.
#include "firmware/control/threshold_law.hpp"

#include "tests/catch.hpp"
#include "tests/control/law_vectors.hpp"

using namespace antiskid::control;
using control_test::balanced;
using control_test::fixed_config;
using control_test::kFull_Pa;
using control_test::kPeriod_s;
using Action = ThresholdLaw::Action;

namespace {

/// `mps2`: rim acceleration of the wheel. Thresholds: slip 0.2 and 0.4, deceleration 35, recovery above 2.
Estimate at(const float slip, const float mps2, const float pressure_Pa = 5e6F) {
    Estimate e = balanced(40.0F, slip, pressure_Pa);
    e.radius_m = 0.5F;  // exact quotients
    e.omega_dot_radps2 = mps2 / e.radius_m;
    return e;
}

struct LawByItself {
    ThresholdLaw law{fixed_config().threshold, kPeriod_s};
    float pressure = 0.0F;

    LawByItself() { law.start(at(0.0F, 0.0F, 5e6F)); }
    Action step(const float slip, const float mps2, const float ceiling = kFull_Pa) {
        pressure = law.pressure_Pa(at(slip, mps2), ceiling);
        return law.action();
    }
    void into(const Action action) {
        if (action == Action::increase) {
            REQUIRE(step(0.1F, -5.0F) == Action::increase);
        } else {
            REQUIRE(step(0.5F, -5.0F) == Action::decrease);
            if (action == Action::hold) {
                REQUIRE(step(0.45F, 3.0F) == Action::hold);
            }
        }
    }
};

struct ActionRow {
    const char* why;
    Action from;
    float slip;
    float mps2;
    Action to;
};

}  // namespace

TEST_CASE("the actions change where the thresholds say", "[CTL-330]") {
    const ActionRow row = GENERATE(values<ActionRow>({
        {"grip", Action::increase, 0.10F, -10.0F, Action::increase},
        {"slip between the thresholds alone", Action::increase, 0.30F, -10.0F, Action::increase},
        {"hard deceleration without slip is the brake's onset", Action::increase, 0.10F, -60.0F, Action::increase},
        {"hard deceleration with slip is a skid", Action::increase, 0.25F, -36.0F, Action::decrease},
        {"slip alone is a skid", Action::increase, 0.41F, -1.0F, Action::decrease},
        {"slipping but recovering already", Action::increase, 0.50F, 3.0F, Action::increase},
        {"still skidding", Action::decrease, 0.50F, -10.0F, Action::decrease},
        {"deep, and turning", Action::decrease, 0.50F, 2.5F, Action::hold},
        {"slip between, no recovery yet", Action::decrease, 0.30F, 1.0F, Action::decrease},
        {"recovered at once", Action::decrease, 0.10F, 0.0F, Action::increase},
        {"waiting for the wheel", Action::hold, 0.30F, 5.0F, Action::hold},
        {"deep but spinning up", Action::hold, 0.60F, 5.0F, Action::hold},
        {"recovered", Action::hold, 0.19F, 5.0F, Action::increase},
        {"skids again", Action::hold, 0.45F, -1.0F, Action::decrease},
        {"skids again by deceleration", Action::hold, 0.25F, -40.0F, Action::decrease},
        {"slip at its threshold", Action::increase, 0.40F, -1.0F, Action::increase},
        {"deceleration at its threshold", Action::increase, 0.30F, -35.0F, Action::increase},
        {"hard deceleration at the lower slip", Action::increase, 0.20F, -60.0F, Action::increase},
        {"recovery at its threshold is none yet", Action::decrease, 0.50F, 2.0F, Action::decrease},
        {"slip at the lower threshold has not recovered", Action::hold, 0.20F, 5.0F, Action::hold},
    }));
    CAPTURE(row.why);
    LawByItself b;
    b.into(row.from);
    CHECK(b.step(row.slip, row.mps2) == row.to);
}

TEST_CASE("the pressure rises, holds and falls at its rates", "[CTL-330]") {
    LawByItself b;
    b.step(0.1F, -5.0F);
    CHECK(b.pressure == Approx(5e6 + 64e6 * 1e-3));  // first rise
    float before = b.pressure;
    b.step(0.5F, -5.0F);
    CHECK(b.pressure == Approx(before - 400e6 * 1e-3));
    b.step(0.5F, -5.0F);
    CHECK(b.pressure == Approx(before - 800e6 * 1e-3));
    b.step(0.45F, 3.0F);
    before = b.pressure;
    for (int i = 0; i < 10; ++i) {
        b.step(0.45F, 3.0F);
        CHECK(b.pressure == before);
    }
    // The skid began at 5 MPa (the measured one): INCREASE starts at 90 % of that.
    b.step(0.1F, 3.0F);
    CHECK(b.pressure == Approx(0.9 * 5e6 + 2e6 * 1e-3).epsilon(1e-5));
    before = b.pressure;
    b.step(0.1F, -3.0F);
    CHECK(b.pressure == Approx(before + 2e6 * 1e-3));
}

TEST_CASE("restoring never lowers the pressure, and a new start forgets the skid", "[CTL-330]") {
    LawByItself b;
    for (int i = 0; i < 100; ++i) b.step(0.1F, -5.0F);  // 11.4 MPa asked for, 5 measured
    b.step(0.5F, -5.0F);
    b.step(0.45F, 3.0F);
    const float held = b.pressure;
    REQUIRE(held > 4.5e6F);
    b.step(0.1F, 3.0F);
    CHECK(b.pressure == Approx(held + 2e6 * 1e-3));
    b.law.start(at(0.0F, 0.0F, 1e6F));
    CHECK(b.law.action() == Action::increase);
    b.step(0.1F, -5.0F);
    CHECK(b.pressure == Approx(1e6 + 64e6 * 1e-3));
}

TEST_CASE("the threshold law stays between nothing and the ceiling", "[CTL-330]") {
    LawByItself b;
    for (int i = 0; i < 1000; ++i) {
        b.step(0.1F, -5.0F, 7e6F);
        REQUIRE(b.pressure <= 7e6F);
    }
    CHECK(b.pressure == 7e6F);
    for (int i = 0; i < 1000; ++i) {
        b.step(0.9F, -5.0F);
        REQUIRE(b.pressure >= 0.0F);
    }
    CHECK(b.pressure == 0.0F);
}
