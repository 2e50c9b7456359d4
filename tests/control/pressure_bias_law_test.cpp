// Pressure-bias modulation: the reference speed, and every term that is taken off the demand, by itself.
#include "firmware/control/pressure_bias_law.hpp"

#include "tests/catch.hpp"
#include "tests/control/law_vectors.hpp"

using namespace antiskid::control;
using control_test::fixed_config;
using control_test::kFull_Pa;
using control_test::kPeriod_s;

namespace {

/// A rim at `mps` that gains `mps2`. Slip, aircraft's speed and prediction are nonsense: the law must not look at them.
Estimate rim_at(const float mps, const float mps2 = 0.0F, const float pressure_Pa = 5e6F) {
    Estimate e;
    e.radius_m = 0.5F;  // exact quotients
    e.omega_radps = mps / e.radius_m;
    e.omega_dot_radps2 = mps2 / e.radius_m;
    e.pressure.pressure_Pa = pressure_Pa;
    e.slip = e.late_slip = 0.9F;
    e.v_mps = e.late_v_mps = 3.0F;
    e.late_balance_Pa = 1e3F;
    return e;
}

/// Reference down by 10 m/s2, dead band 2 m/s, 0.5 MPa per m/s at once, 8 MPa per m, bleeds of 64 and 4 MPa/s, bias up to 0.9 of the
/// demand, lead 10 kPa per m/s2 beyond 40 m/s2.
struct Modulation {
    PressureBiasLaw law;
    float pressure_Pa = 0.0F;

    explicit Modulation(const PressureBiasConfig& config = fixed_config().pressure_bias) : law(config, kPeriod_s) { law.start(rim_at(40.0F)); }
    float step(const float mps, const float mps2 = 0.0F, const float ceiling_Pa = kFull_Pa) {
        pressure_Pa = law.pressure_Pa(rim_at(mps, mps2), ceiling_Pa);
        return pressure_Pa;
    }
    /// A skid that is over again: from here on the bias bleeds slowly.
    void skid() {
        step(37.5F);
        step(40.0F);
    }
};

PressureBiasConfig without(float PressureBiasConfig::*const gain, float PressureBiasConfig::*const other) {
    PressureBiasConfig c = fixed_config().pressure_bias;
    c.*gain = 0.0F;
    c.*other = 0.0F;
    return c;
}

}  // namespace

TEST_CASE("the pressure-bias law starts at the pressure that it finds and rises until the first skid", "[CTL-330]") {
    Modulation b;
    for (int i = 1; i <= 100; ++i) CHECK(b.step(40.0F) == Approx(5e6 + 64e3 * i).epsilon(1e-5));
    CHECK(b.law.bias_Pa() == Approx(kFull_Pa - 11.4e6).epsilon(1e-5));
    b.skid();
    float before_Pa = b.pressure_Pa;
    for (int i = 0; i < 100; ++i) {
        CHECK(b.step(40.0F) - before_Pa == Approx(4e3).margin(2.0));
        before_Pa = b.pressure_Pa;
    }
    for (int i = 0; i < 3000; ++i) b.step(40.0F);
    CHECK(b.pressure_Pa == kFull_Pa);
    CHECK(b.law.bias_Pa() == 0.0F);

    b.law.start(rim_at(40.0F, 0.0F, 1e6F));  // skids are forgotten: the bias of the demand of that moment
    CHECK(b.law.pressure_Pa(rim_at(40.0F), 3e6F) == Approx(1e6 + 64e3).epsilon(1e-5));
    b.law.start(rim_at(40.0F, 0.0F, 4e6F));
    CHECK(b.law.pressure_Pa(rim_at(40.0F), 3e6F) == 3e6F);  // more pressure than demand leaves no bias below none
    CHECK(b.law.bias_Pa() == 0.0F);
}

TEST_CASE("the reference speed follows the wheel up at once and down at its rate", "[CTL-330]") {
    Modulation b;
    CHECK(b.law.reference_mps() == 40.0F);
    b.step(45.0F);
    CHECK(b.law.reference_mps() == 45.0F);
    for (int i = 1; i <= 200; ++i) {
        b.step(20.0F);
        CHECK(b.law.reference_mps() == Approx(45.0 - 0.01 * i).margin(1e-3));
    }
    b.step(43.005F);
    CHECK(b.law.reference_mps() == 43.005F);
    b.step(43.0F);  // an aircraft may slow so
    CHECK(b.law.reference_mps() == 43.0F);
    b.law.start(rim_at(12.0F));
    CHECK(b.law.reference_mps() == 12.0F);
    b.law.resume(rim_at(14.0F));
    CHECK(b.law.reference_mps() == 14.0F);
}

TEST_CASE("velocity error beyond the dead band comes off at once", "[CTL-330]") {
    Modulation b(without(&PressureBiasConfig::k_bias_Pa_per_m, &PressureBiasConfig::k_lead_Pa_per_mps2));
    b.step(40.0F);
    b.step(38.0F);  // the reference is at 39.99
    CHECK(b.pressure_Pa == Approx(5e6 + 128e3).epsilon(1e-5));
    const float bias_Pa = b.law.bias_Pa();
    b.step(34.98F);  // 39.98: 3 m/s beyond it, and no bleeding
    CHECK(b.law.bias_Pa() == bias_Pa);
    CHECK(kFull_Pa - bias_Pa - b.pressure_Pa == Approx(1.5e6).epsilon(1e-4));
    b.step(40.0F);
    CHECK(b.pressure_Pa == Approx(5e6 + 132e3).epsilon(1e-5));  // it has skidded
}

TEST_CASE("velocity error beyond the dead band adds to the bias", "[CTL-330]") {
    Modulation b(without(&PressureBiasConfig::k_transient_Pa_per_mps, &PressureBiasConfig::k_lead_Pa_per_mps2));
    b.step(40.0F);
    for (int i = 0; i < 10; ++i) b.step(34.99F - 0.01F * static_cast<float>(i));  // 3 m/s beyond it
    CHECK(b.pressure_Pa == Approx(5e6 + 64e3 - 10 * 24e3).epsilon(1e-4));
    b.step(40.0F);
    CHECK(b.pressure_Pa == Approx(5e6 + 64e3 - 10 * 24e3 + 4e3).epsilon(1e-4));
}

TEST_CASE("the wheel's deceleration comes off without error", "[CTL-330]") {
    Modulation b;
    const auto lead_Pa = [&b](const float mps2) {
        b.step(40.0F, mps2);
        return kFull_Pa - b.law.bias_Pa() - b.pressure_Pa;
    };
    CHECK(lead_Pa(-140.0F) == Approx(1e6).epsilon(1e-5));
    CHECK(lead_Pa(-40.0F) == 0.0F);
    CHECK(lead_Pa(-41.0F) == Approx(1e4).margin(4.0));
    CHECK(lead_Pa(140.0F) == 0.0F);
    CHECK(b.pressure_Pa == Approx(5e6 + 4 * 64e3).epsilon(1e-5));  // a lead is no skid
}

TEST_CASE("the bias stays within its share of the demand, the pressure between nothing and the demand", "[CTL-330]") {
    Modulation b(without(&PressureBiasConfig::k_transient_Pa_per_mps, &PressureBiasConfig::k_lead_Pa_per_mps2));
    for (int i = 0; i < 2000; ++i) b.step(0.0F);
    CHECK(b.law.bias_Pa() == Approx(0.9 * kFull_Pa));
    CHECK(b.pressure_Pa == Approx(0.1 * kFull_Pa).epsilon(1e-4));
    b.step(0.0F, 0.0F, 10e6F);  // a demand that falls takes its share of the bias with it
    CHECK(b.law.bias_Pa() == Approx(9e6));
    CHECK(b.pressure_Pa == Approx(1e6).epsilon(1e-4));
    CHECK(b.step(0.0F, 0.0F, 0.0F) == 0.0F);

    Modulation all;
    for (int i = 0; i < 2000; ++i) REQUIRE(all.step(0.0F, -1000.0F) >= 0.0F);
    CHECK(all.pressure_Pa == 0.0F);
    for (int i = 0; i < 8000; ++i) REQUIRE(all.step(40.0F, 1000.0F, 7e6F) <= 7e6F);
    CHECK(all.pressure_Pa == 7e6F);
}

TEST_CASE("after a lock the bias goes on where it was, and slowly", "[CTL-330]") {
    Modulation b;
    for (int i = 0; i < 50; ++i) b.step(40.0F);
    const float bias_Pa = b.law.bias_Pa();
    b.law.resume(rim_at(28.0F, 0.0F, 0.0F));
    b.step(28.0F);
    CHECK(b.law.bias_Pa() == Approx(bias_Pa - 4e3F).margin(2.0));

    b.law.forget_runway();
    b.law.resume(rim_at(28.0F, 0.0F, 3e6F));  // none is left: from the present pressure, still slowly
    CHECK(b.step(28.0F) == Approx(3e6 + 4e3).margin(4.0));

    PressureBiasLaw fresh(fixed_config().pressure_bias, kPeriod_s);
    fresh.resume(rim_at(28.0F, 0.0F, 4e6F));
    CHECK(fresh.pressure_Pa(rim_at(28.0F), kFull_Pa) == Approx(4e6 + 4e3).margin(4.0));
}
