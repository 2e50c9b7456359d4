/// The meter against stops whose figures are known in closed form.
#include "plant_sim/study/stop_meter.hpp"

#include <cmath>

#include "firmware/host/settings/json.hpp"
#include "plant_sim/study/report.hpp"
#include "tests/catch.hpp"
#include "tests/study/scenarios.hpp"

namespace {
rig::RigParameters heavy() {
    return plant_sim::load_scenario(scenarios::options({"dry_asphalt", "heavy"})).plant.rig;
}
}  // namespace

TEST_CASE("a wheel locked from the start: all energy to the tyre, J_mu = mu(1) / mu_max, distance in closed form", "[STUDY-030]") {
    rig::RigParameters p = heavy();
    p.load.lift_Ns2pm2 = 0.0;  // constant load: constant deceleration
    plant::Rig rig(p, 1e-3, 1);
    study::StopMeter meter(0.24, 5.0);
    rig.touch_down();
    rig.advance_pressure(20.7e6, 20.7e6);  // held from the first instant: it never spins up
    meter.start(rig);
    const double v0 = rig.wheel().v_mps;
    while (!rig.standstill()) {
        rig.advance_pressure(20.7e6, 20.7e6);
        meter.update(rig, 1e-3);
    }
    const study::StopFigures f = meter.figures(rig);
    const double mu_1 = rig::friction(p.surface, 1.0).mu;
    CHECK(f.stop_distance_m == Approx(v0 * v0 / (2.0 * mu_1 * 9.80665)).epsilon(1e-5));
    CHECK(f.j_mu == Approx(mu_1 / rig::peak(p.surface).mu).epsilon(1e-9));
    CHECK(f.energy_brake_J == 0.0);
    CHECK(f.energy_tyre_J == Approx(0.5 * p.wheel.mass_kg * v0 * v0).epsilon(1e-5));
    CHECK(f.peak_slip == 1.0);
    CHECK(f.slip_efficiency == Approx(0.5).epsilon(1e-9));
    CHECK(f.tracked_tyre_share == 1.0);
    CHECK(f.longest_lock_s == Approx((v0 - 5.0) / (mu_1 * 9.80665)).margin(2e-3));
    CHECK(f.tracked_share == 0.0);
    CHECK(f.mean_load_N == Approx(p.load.base_N).epsilon(1e-9));
}

TEST_CASE("a stop that begins below the speeds that tracking is measured at has no share of it", "[STUDY-030]") {
    rig::RigParameters p = heavy();
    p.brake_on_mps = p.touchdown_mps = 16.667;
    plant::Rig rig(p, 1e-3, 1);
    rig.start_rolling();
    study::StopMeter meter(0.24, 5.0);
    meter.start(rig);
    while (!rig.standstill()) {
        rig.advance_pressure(6e6, 6e6);
        meter.update(rig, 1e-3);
    }
    study::StopReport report;
    report.figures = meter.figures(rig);
    CHECK_FALSE(report.figures.tracked_share);
    CHECK_FALSE(report.figures.tracked_tyre_share);
    CHECK(report.figures.stop_distance_m > 0.0);
    CHECK_THAT(study::to_table(report), ContainsSubstring("not measured"));
    CHECK(settings::parse_json(study::to_json(report)).at("tracked_share").is_null());
}

TEST_CASE("eq. (7) gives back the friction that the brake had", "[STUDY-030]") {
    rig::RigParameters p = heavy();
    p.friction_curve = {0.3, 0.0, 0.0, 0.0};
    p.mean_friction = 0.27;
    plant::Rig rig(p, 1e-3, 1);
    rig.start_rolling();
    study::StopMeter meter(0.24, 5.0);
    meter.start(rig);
    while (rig.wheel().v_mps > 5.0) {
        rig.advance_pressure(6e6, 6e6);
        meter.update(rig, 1e-3);
    }
    CHECK(meter.figures(rig).mean_friction == Approx(0.27).epsilon(1e-6));
}

TEST_CASE("the valve's travel counts from brake-on to drop-out, against the time between", "[STUDY-030]") {
    rig::RigParameters p = heavy();
    plant::Rig rig(p, 1e-3, 1);
    rig.start_rolling();
    study::StopMeter meter(0.24, 5.0);
    for (int i = 0; i < 100; ++i) meter.command(i % 2 == 0 ? 0.0 : 40.0);  // before brake-on
    meter.command(10.0);
    meter.start(rig);
    double drop_out_s = 0.0, travel_mA = 0.0;
    for (int i = 0; !rig.standstill(); ++i) {
        // 0.25 mA up in each of four periods, 1 mA down in the fifth: 2 mA in 5 ms. A swing from limit to limit below drop-out.
        const double current_mA = drop_out_s > 0.0 ? (i % 2 == 0 ? 0.0 : 40.0) : 10.0 + 0.25 * (i % 5);
        meter.command(current_mA);
        rig.advance_pressure(6e6, 6e6);
        meter.update(rig, 1e-3);
        if (drop_out_s > 0.0) continue;
        if (i > 0) travel_mA += i % 5 == 0 ? 1.0 : 0.25;
        if (rig.wheel().v_mps <= 5.0) drop_out_s = rig.time_s();
    }
    const study::StopFigures f = meter.figures(rig);
    REQUIRE(f.valve_travel_mAps);
    CHECK(*f.valve_travel_mAps == Approx(travel_mA / drop_out_s).epsilon(1e-9));
    CHECK(*f.valve_travel_mAps == Approx(400.0).epsilon(1e-3));
}

TEST_CASE("a stop without a valve current has no travel; every landing under a controller has", "[STUDY-030]") {
    plant::Rig rig(heavy(), 1e-3, 1);
    rig.start_rolling();
    study::StopMeter meter(0.24, 5.0);
    meter.start(rig);
    while (!rig.standstill()) {
        rig.advance_pressure(6e6, 6e6);
        meter.update(rig, 1e-3);
    }
    study::StopReport report;
    report.figures = meter.figures(rig);
    CHECK_FALSE(report.figures.valve_travel_mAps);
    CHECK_THAT(study::to_table(report), ContainsSubstring("valve travel above drop-out        not measured"));
    CHECK(settings::parse_json(study::to_json(report)).at("valve_travel_mAps").is_null());

    // As the observer of a run sees the currents, whatever carries them.
    for (const auto link : {study::Link::rounded, study::Link::frames}) {
        double last_mA = 0.0, travel_mA = 0.0, seconds = 0.0;
        const auto watch = [&](const study::RigSession& s, const antiskid::can::ControllerView&, double current_mA) {
            if (s.pilot().phase() == study::StopPhase::braking && s.rig().wheel().v_mps > 5.0) {
                travel_mA += std::abs(current_mA - last_mA);
                seconds += 1e-3;
            }
            last_mA = current_mA;
        };
        const auto run = scenarios::run(scenarios::options({"wet_asphalt", "heavy"}), link, watch);
        CHECK(run.figures.valve_travel_mAps.value() == Approx(travel_mA / seconds).epsilon(2e-3));
    }
}

TEST_CASE("wheel-slip efficiency: the printed formula at its corners", "[STUDY-030]") {
    CHECK(study::slip_efficiency(-0.2, 0.16) == 0.0);
    CHECK(study::slip_efficiency(0.0, 0.16) == 0.0);
    CHECK(study::slip_efficiency(0.08, 0.16) == Approx(1.5 * 0.5 - 0.5 * 0.125).epsilon(1e-12));
    CHECK(study::slip_efficiency(0.16, 0.16) == 1.0);
    CHECK(study::slip_efficiency(0.58, 0.16) == Approx(0.75).epsilon(1e-12));
    CHECK(study::slip_efficiency(1.0, 0.16) == 0.5);
    CHECK(study::slip_efficiency(1.0, 1.0) == 1.0);  // a curve without an interior peak
}

TEST_CASE("a slip that is held: efficiency and the tyre's share of the energy are those of that slip", "[STUDY-030]") {
    constexpr double kSlip = 0.24;
    auto options = scenarios::options({"wet_asphalt", "heavy"});
    const auto run = scenarios::run(options);
    const double optimum = rig::peak(plant_sim::load_scenario(options).plant.rig.surface).slip;
    // Pressure build-up and the lowering of the reference below 23.6 m/s stand between the two.
    CHECK(run.figures.slip_efficiency == Approx(study::slip_efficiency(kSlip, optimum)).margin(0.02));
    CHECK(run.figures.tracked_tyre_share.value() == Approx(kSlip).margin(0.005));
}

TEST_CASE("on a runway of patches J_mu counts against the surface under the wheel", "[RIG-262][STUDY-030]") {
    rig::RigParameters p = heavy();
    p.load.lift_Ns2pm2 = 0.0;
    const rig::Surface snow{.name = "snow", .c1 = 0.1946, .c2 = 94.129, .c3 = 0.0646};
    p.runway.patches = {{50.0, snow}, {120.0, p.surface}};
    plant::Rig rig(p, 1e-3, 1);
    study::StopMeter meter(0.24, 5.0);
    rig.touch_down();
    rig.advance_pressure(20.7e6, 20.7e6);  // a locked wheel: friction is that of slip 1 on each patch
    meter.start(rig);
    double max = 0.0, had = 0.0, begins_m = -1.0, ends_m = -1.0;
    while (!rig.standstill()) {
        const double before_m = rig.wheel().distance_m;
        rig.advance_pressure(20.7e6, 20.7e6);
        meter.update(rig, 1e-3);
        const bool on_snow = rig.surface().name == "snow";
        if (on_snow && begins_m < 0.0) begins_m = before_m;
        if (!on_snow && begins_m >= 0.0 && ends_m < 0.0) ends_m = before_m;
        if (rig.wheel().v_mps < 5.0) continue;
        const rig::Surface& under = on_snow ? snow : p.surface;
        const double metres = rig.wheel().distance_m - before_m;
        max += rig::peak(under).mu * metres;
        had += rig::friction(under, 1.0).mu * metres;
    }
    CHECK(begins_m == Approx(50.0).margin(0.07));
    CHECK(ends_m == Approx(120.0).margin(0.07));
    CHECK(meter.figures(rig).j_mu == Approx(had / max).epsilon(1e-4));
    CHECK(std::abs(meter.figures(rig).energy_residual) < 1e-9);
}
