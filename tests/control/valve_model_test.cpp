// The controller's picture of the valve against closed forms and an independent integration.
#include "firmware/control/valve_model.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include "tests/catch.hpp"
#include "tests/control/fixed_config.hpp"
#include "tests/control/valve_truth.hpp"

using namespace antiskid::control;
using control_test::fixed_config;
using control_test::kInf;
using control_test::kNaN;
using control_test::ValveTruth;

namespace {

/// Unit step response of omega_n^2 / (s^2 + 2 xi omega_n s + omega_n^2), by textbook.
double step_response(const double w, const double xi, const double t) {
    if (t <= 0.0) return 0.0;
    if (std::abs(xi - 1.0) < 1e-9) return 1.0 - std::exp(-w * t) * (1.0 + w * t);
    if (xi < 1.0) {
        const double wd = w * std::sqrt(1.0 - xi * xi);
        return 1.0 - std::exp(-xi * w * t) * (std::cos(wd * t) + xi * w / wd * std::sin(wd * t));
    }
    const double root = std::sqrt(xi * xi - 1.0);
    const double s1 = -w * (xi - root), s2 = -w * (xi + root);
    return 1.0 + (s2 * std::exp(s1 * t) - s1 * std::exp(s2 * t)) / (s1 - s2);
}

ValveConfig valve(const double frequency_Hz, const double damping, const double delay_s) {
    ValveConfig v = fixed_config().valve;
    v.natural_frequency_radps = static_cast<float>(2.0 * std::numbers::pi * frequency_Hz);
    v.damping = static_cast<float>(damping);
    v.delay_s = static_cast<float>(delay_s);
    return v;
}

}  // namespace

TEST_CASE("the static map is hit at its points and linear between them", "[CTL-020]") {
    const ValveConfig v = fixed_config().valve;
    for (std::size_t i = 0; i < v.points; ++i) {
        CAPTURE(i);
        CHECK(valve_pressure_Pa(v, v.current_mA[i]) == v.pressure_Pa[i]);
        if (i == 0) continue;
        CHECK(valve_current_mA(v, v.pressure_Pa[i]) == v.current_mA[i]);
        const float middle = 0.5F * (v.current_mA[i] + v.current_mA[i - 1]);
        CHECK(valve_pressure_Pa(v, middle) == Approx(0.5F * (v.pressure_Pa[i] + v.pressure_Pa[i - 1])).epsilon(1e-6));
    }
    CHECK(valve_pressure_Pa(v, 0.0F) == 0.0F);
    CHECK(valve_pressure_Pa(v, 2.9F) == 0.0F);
    CHECK(valve_pressure_Pa(v, 1e9F) == 20.7e6F);
}

TEST_CASE("a map may use every point there is, or only two", "[CTL-020]") {
    ValveConfig v;
    v.points = ValveConfig::kMaxPoints;
    for (std::size_t i = 0; i < ValveConfig::kMaxPoints; ++i) {
        v.current_mA[i] = 2.0F + static_cast<float>(i);
        v.pressure_Pa[i] = 1e6F * static_cast<float>(i);
    }
    CHECK(valve_pressure_Pa(v, 17.0F) == 15e6F);
    CHECK(valve_pressure_Pa(v, 99.0F) == 15e6F);
    CHECK(valve_current_mA(v, 99e6F) == 17.0F);
    // Points beyond those in use are not looked at.
    v.points = 2;
    CHECK(valve_pressure_Pa(v, 17.0F) == 1e6F);
    CHECK(valve_current_mA(v, 15e6F) == 3.0F);
}

TEST_CASE("map and inverse map are each other's inverse", "[CTL-020]") {
    const ValveConfig v = fixed_config().valve;
    float before_mA = 0.0F;
    for (int i = 1; i <= 20'700; ++i) {
        const float pressure = 1e3F * static_cast<float>(i);
        const float current = valve_current_mA(v, pressure);
        REQUIRE(current > before_mA);
        before_mA = current;
        REQUIRE(valve_pressure_Pa(v, current) == Approx(pressure).epsilon(1e-6).margin(2.0));
    }
    for (int i = 301; i <= 4000; ++i) {
        const float current = 0.01F * static_cast<float>(i);
        REQUIRE(valve_current_mA(v, valve_pressure_Pa(v, current)) == Approx(current).epsilon(1e-6));
    }
}

TEST_CASE("no pressure asks for the safe current, and what is no number for no pressure", "[CTL-020]") {
    ValveConfig v = fixed_config().valve;
    v.safe_current_mA = 1.5F;
    for (const float none : {0.0F, -0.0F, -1.0F, -kInf, kNaN}) CHECK(valve_current_mA(v, none) == 1.5F);
    CHECK(valve_current_mA(v, 1.0F) >= 3.0F);  // the dead zone is jumped
    CHECK(valve_current_mA(v, kInf) == 40.0F);
    CHECK(valve_current_mA(v, 30e6F) == 40.0F);
    CHECK(valve_pressure_Pa(v, kNaN) == 0.0F);
}

TEST_CASE("the step response is the textbook's, delay a whole number of periods", "[CTL-020]") {
    const double period_s = GENERATE(1e-3, 2e-3, 5e-3);
    const double frequency_Hz = GENERATE(5.0, 20.0, 60.0, 200.0);
    const double damping = GENERATE(0.1, 0.8, 1.0, 2.0);
    const int periods = GENERATE(0, 1, 3, 16);
    ValveModel model(valve(frequency_Hz, damping, periods * period_s), static_cast<float>(period_s), {.pressure_bandwidth_radps = 470.0F});
    const double w = 2.0 * std::numbers::pi * frequency_Hz;
    const auto u = 10e6F;
    CHECK(model.delay_s() == Approx(periods * period_s));
    for (int k = 1; k <= 400; ++k) {
        model.update(u, 0.0F, false);
        const double truth = 10e6 * step_response(w, damping, (k - periods) * period_s);
        CAPTURE(k, period_s, frequency_Hz, damping, periods);
        REQUIRE(std::abs(static_cast<double>(model.now().pressure_Pa) - truth) < 10e6 * 1e-4);
        REQUIRE(model.now().pressure_Pa == model.uncorrected_Pa());
    }
    if (frequency_Hz * damping > 10.0) CHECK(model.now().pressure_Pa == Approx(u).epsilon(1e-4));
}

TEST_CASE("a delay that is no multiple of the period is shared between two commands", "[CTL-020]") {
    const double period_s = GENERATE(1e-3, 2e-3, 5e-3);
    const double delay_s = GENERATE(0.4e-3, 6.3e-3, 7.5e-3, 9.9e-3);
    const ValveConfig v = valve(20.0, 0.8, delay_s);
    ValveModel model(v, static_cast<float>(period_s), {.pressure_bandwidth_radps = 470.0F});
    const double w = 2.0 * std::numbers::pi * 20.0;
    // Inside one period the model spreads the command evenly, the valve switches: for a second-order lag the two differ by at most
    // (w h)^2 / 8 of the step, from the double integral of w^2 (u - mean).
    const double tolerance = 10e6 * (w * period_s * w * period_s / 8.0 + 1e-4);
    for (int k = 1; k <= 200; ++k) {
        model.update(10e6F, 0.0F, false);
        const double truth = 10e6 * step_response(w, 0.8, k * period_s - delay_s);
        CAPTURE(k, period_s, delay_s);
        REQUIRE(std::abs(static_cast<double>(model.now().pressure_Pa) - truth) <= tolerance);
    }
}

TEST_CASE("random commands: the model is an independent integration of eq. (6)", "[CTL-020]") {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> command(0.0F, 20.7e6F);
    const int held = GENERATE(1, 4, 15);
    ValveModel model(valve(20.0, 0.8, 6e-3), 1e-3F, {.pressure_bandwidth_radps = 470.0F});
    ValveTruth truth(2.0 * std::numbers::pi * 20.0, 0.8, 6e-3);
    float u = 0.0F;
    for (int k = 0; k < 3000; ++k) {
        if (k % held == 0) u = command(random);
        truth.hold(static_cast<double>(u), 1e-3);
        model.update(u, 0.0F, false);
        CAPTURE(k);
        REQUIRE(static_cast<double>(model.now().pressure_Pa) == Approx(truth.pressure_Pa()).margin(20.7e6 * 1e-4));
        REQUIRE(static_cast<double>(model.now().rate_Paps) == Approx(truth.rate_Paps()).margin(2.6e9 * 1e-4));
    }
}

TEST_CASE("the prediction is what then happens, whatever is commanded from now on", "[CTL-020]") {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> command(0.0F, 20.7e6F);
    const double delay_s = GENERATE(0.0, 0.5e-3, 1e-3, 6e-3, 6.4e-3, 16e-3);
    ValveModel model(valve(20.0, 0.8, delay_s), 1e-3F, {.pressure_bandwidth_radps = 470.0F});
    const auto ahead = static_cast<std::size_t>(delay_s * 1e3 + 1e-9);
    CHECK(model.delay_s() == Approx(1e-3 * static_cast<double>(ahead)));
    CHECK(model.delay_periods() == ahead);
    for (int k = 0; k < 500; ++k) {
        model.update(command(random), 0.0F, false);
        ValveModel later = model;
        PressureState expected = model.now();
        for (std::size_t periods = 1; periods <= ahead; ++periods) {
            expected = model.after(expected, periods);
            later.update(command(random), 0.0F, false);
            CAPTURE(k, delay_s, periods);
            REQUIRE(expected.pressure_Pa == later.now().pressure_Pa);
            REQUIRE(expected.rate_Paps == later.now().rate_Paps);
        }
    }
}

TEST_CASE("measurements correct the model, the uncorrected one ignores them", "[CTL-020]") {
    ValveModel model(valve(20.0, 0.8, 6e-3), 1e-3F, {.pressure_bandwidth_radps = 470.0F});
    // A valve that gives 2 MPa more than commanded.
    for (int k = 0; k < 200; ++k) model.update(6e6F, 8e6F, true);
    CHECK(model.uncorrected_Pa() == Approx(6e6F).epsilon(1e-3));
    CHECK(model.now().pressure_Pa > 7.2e6F);
    CHECK(model.now().pressure_Pa < 8e6F);
    // A reading that is not fresh changes nothing.
    ValveModel same = model;
    model.update(6e6F, 1e6F, false);
    same.update(6e6F, 19e6F, false);
    CHECK(model.now().pressure_Pa == same.now().pressure_Pa);
    CHECK(model.now().rate_Paps == same.now().rate_Paps);

    // An offset at start dies within 20 ms.
    ValveModel late(valve(20.0, 0.8, 6e-3), 1e-3F, {.pressure_bandwidth_radps = 470.0F});
    ValveTruth truth(2.0 * std::numbers::pi * 20.0, 0.8, 6e-3);
    truth.hold(9e6, 0.5);
    for (int k = 0; k < 20; ++k) {
        truth.hold(9e6, 1e-3);
        late.update(9e6F, static_cast<float>(truth.pressure_Pa()), true);
    }
    CHECK(late.now().pressure_Pa == Approx(9e6).epsilon(0.02));
}

TEST_CASE("what the valve gives beside its map is learnt and made up for", "[CTL-020]") {
    const float gain = GENERATE(0.88F, 1.12F);  // of the valve's pressure over its map's
    const EstimatorConfig learns{.pressure_bandwidth_radps = 30.0F, .valve_offset_radps = 7.0F, .valve_offset_share = 0.25F};
    const ValveConfig v = valve(20.0, 0.8, 6e-3);
    ValveModel model(v, 1e-3F, learns);
    ValveTruth truth(2.0 * std::numbers::pi * 20.0, 0.8, 6e-3);
    constexpr float kRequested_Pa = 10e6F;
    float given_Pa = kRequested_Pa;
    const auto run = [&](const int periods) {
        for (int k = 0; k < periods; ++k) {
            truth.hold(static_cast<double>(gain * given_Pa), 1e-3);
            model.update(given_Pa, static_cast<float>(truth.pressure_Pa()), true);
            given_Pa = model.compensated_Pa(kRequested_Pa);
        }
        return truth.pressure_Pa() / 10e6 - 1.0;
    };
    // At rest the correction of the state takes part of the error: p - p_model = offset / (1 + 2 xi L / w + L^2 / (2 w^2)), so that is what
    // the offset is learnt from. From 0.2 s on, when the lag has settled, the error falls at that rate, as the valve's gain has it.
    const double w = 2.0 * std::numbers::pi * 20.0, l = 30.0;
    const double rate = 7.0 / (1.0 + 2.0 * 0.8 * l / w + l * l / (2.0 * w * w)) * static_cast<double>(gain);
    const double early = run(200), late = run(200);
    CHECK(std::abs(early) < 0.06);
    CHECK(early * (static_cast<double>(gain) - 1.0) > 0.0);
    // Delay and lag in that loop make it up to a tenth faster: s = rate e^{s T}, T about 14 ms.
    const double measured = std::log(early / late) / 0.2;
    CHECK(measured > rate);
    CHECK(measured < 1.1 * rate);
    CHECK(std::abs(run(2000)) < 1e-4);
    CHECK(model.now().pressure_Pa == Approx(kRequested_Pa).epsilon(1e-4));
    CHECK(model.uncorrected_Pa() == Approx(kRequested_Pa / gain).epsilon(1e-3));  // the map's view: it is that far off
    PressureState ahead = model.now();
    for (std::size_t periods = 1; periods <= model.delay_periods(); ++periods) {
        ahead = model.after(ahead, periods);
        CHECK(ahead.pressure_Pa == Approx(kRequested_Pa).epsilon(1e-4));
    }

    ValveModel blind(v, 1e-3F, {.pressure_bandwidth_radps = 30.0F, .valve_offset_share = 0.25F});
    for (int k = 0; k < 500; ++k) blind.update(10e6F, 8e6F, true);
    CHECK(blind.compensated_Pa(kRequested_Pa) == kRequested_Pa);
}

TEST_CASE("what is made up for is a share of what is asked, and what is learnt one of full pressure", "[CTL-020]") {
    const float sign = GENERATE(-1.0F, 1.0F);
    const ValveConfig v = valve(20.0, 0.8, 6e-3);
    ValveModel model(v, 1e-3F, {.pressure_bandwidth_radps = 30.0F, .valve_offset_radps = 7.0F, .valve_offset_share = 0.25F});
    // Off by 8 MPa for ten seconds, as no valve that is only off its map is.
    for (int k = 0; k < 10'000; ++k) model.update(10e6F, 10e6F + sign * 8e6F, true);
    CHECK(model.compensated_Pa(0.0F) == 0.0F);
    CHECK(model.compensated_Pa(4e6F) == 4e6F - sign * 1e6F);
    CHECK(model.compensated_Pa(20e6F) == 20e6F - sign * 5e6F);
    CHECK(model.compensated_Pa(30e6F) == 30e6F - sign * 0.25F * v.full_pressure_Pa);
    // What is not fresh teaches nothing.
    const float before = model.compensated_Pa(30e6F);
    for (int k = 0; k < 100; ++k) model.update(10e6F, 10e6F, false);
    CHECK(model.compensated_Pa(30e6F) == before);
    // Nothing has wound up: a second of a sound valve is enough.
    for (int k = 0; k < 1000; ++k) model.update(10e6F, 10e6F, true);
    CHECK(model.compensated_Pa(30e6F) == Approx(30e6F).epsilon(1e-3));
}

TEST_CASE("a pressure that is further off than any offset leaves it teaches no more of one", "[CTL-020]") {
    const float sign = GENERATE(-1.0F, 1.0F);
    const ValveConfig v = valve(20.0, 0.8, 6e-3);
    const auto learnt_Pa = [&](const float off_Pa, const int periods) {
        ValveModel model(v, 1e-3F, {.pressure_bandwidth_radps = 30.0F, .valve_offset_radps = 7.0F, .valve_offset_share = 0.25F});
        for (int k = 0; k < periods; ++k) model.update(0.0F, sign * off_Pa, true);
        return static_cast<double>(sign * model.offset_Pa());
    };
    // Before the state follows, an innovation is all of what the pressure is off by. An offset of 0.25 * 20.7 MPa at rest leaves
    // 1 / (1 + 2 xi L / w + L^2 / (2 w^2)) of itself.
    const double w = 2.0 * std::numbers::pi * 20.0, l = 30.0;
    const double max = 0.25 * 20.7e6 / (1.0 + 2.0 * 0.8 * l / w + l * l / (2.0 * w * w));
    CHECK(learnt_Pa(1e6F, 1) == Approx(7.0 * 1e-3 * 1e6));
    CHECK(learnt_Pa(0.99F * static_cast<float>(max), 1) == Approx(7.0 * 1e-3 * 0.99 * max));
    CHECK(learnt_Pa(20e6F, 1) == Approx(7.0 * 1e-3 * max));
    CHECK(learnt_Pa(20e6F, 10) == Approx(7.0 * 10e-3 * max));
}

TEST_CASE("a map that begins above no pressure is held before its first point", "[CTL-020]") {
    ValveConfig valve = fixed_config().valve;
    valve.pressure_Pa[0] = 0.1e6F;
    CHECK(valve_pressure_Pa(valve, 2.0F) == 0.1e6F);
    CHECK(valve_pressure_Pa(valve, 3.0F) == 0.1e6F);
    CHECK(valve_current_mA(valve, 0.1e6F) == valve.safe_current_mA);
    CHECK(valve_current_mA(valve, std::nextafter(0.1e6F, 1e6F)) == Approx(3.0F));
}
