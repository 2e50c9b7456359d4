/// Flywheel mode: rim speed for aircraft speed, the loading device for eq. (2), and the endurance stop of Table III.
#include <cmath>

#include "plant_sim/scenario/stop_options.hpp"
#include "plant_sim/study/in_process.hpp"
#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"

namespace {

rig::RigParameters endurance_rig() {
    rig::ManeuverChoice choice;
    choice.maneuver = rig::kEndurance;
    return rig::load_rig("config", choice).rig;
}

/// J_f domega_f/dt = -R_f F_x and J_w domega/dt = r F_x - T_b, integrated as they are printed, in tiny explicit steps.
struct FlywheelAndWheel {
    double J_f = 0.0, R_f = 0.0;
    rig::RigParameters rig;
    double omega_f = 0.0, omega = 0.0;

    struct Rates {
        double omega_f, omega;
    };
    [[nodiscard]] Rates rates(double flywheel, double wheel, double torque_Nm) const {
        const double F_z = rig.load.base_N;
        const double r = rig.wheel.free_radius_m - F_z / rig.wheel.stiffness_Npm;
        const double slip = (R_f * flywheel - wheel * r) / (R_f * flywheel);
        const double F_x = F_z * (rig.surface.c1 * (1.0 - std::exp(-rig.surface.c2 * slip)) - rig.surface.c3 * slip);
        return {-R_f * F_x / J_f, (r * F_x - torque_Nm) / rig.wheel.inertia_kgm2};
    }
    void step(double torque_Nm, double h) {
        const Rates k1 = rates(omega_f, omega, torque_Nm);
        const Rates k2 = rates(omega_f + 0.5 * h * k1.omega_f, omega + 0.5 * h * k1.omega, torque_Nm);
        const Rates k3 = rates(omega_f + 0.5 * h * k2.omega_f, omega + 0.5 * h * k2.omega, torque_Nm);
        const Rates k4 = rates(omega_f + h * k3.omega_f, omega + h * k3.omega, torque_Nm);
        omega_f += h / 6.0 * (k1.omega_f + 2.0 * (k2.omega_f + k3.omega_f) + k4.omega_f);
        omega += h / 6.0 * (k1.omega + 2.0 * (k2.omega + k3.omega) + k4.omega);
    }
};

}  // namespace

TEST_CASE("flywheel: J_f and R_f act as the mass J_f / R_f^2 on the rim", "[RIG-100]") {
    rig::RigParameters rig = endurance_rig();
    const auto doc = settings::Document::load("config/flywheel_rig.toml");
    const double J_f = doc.root().table("flywheel").number("inertia_kgm2");
    const double R_f = doc.root().table("flywheel").number("radius_m");
    CHECK(rig.wheel.mass_kg == Approx(J_f / (R_f * R_f)).epsilon(1e-15));
    rig.load.lag_s = 0.0;
    rig.friction_curve = {rig.mean_friction, 0.0, 0.0, 0.0};

    plant::Rig plant(rig, 1e-3, 1);
    plant.start_rolling();
    FlywheelAndWheel truth{J_f, R_f, rig};
    truth.omega_f = rig.brake_on_mps / R_f;
    truth.omega = plant.wheel().omega_radps;
    constexpr double kPressure_Pa = 9.4e6;
    const double torque_Nm = rig.mean_friction * rig.brake.gain_m3() * kPressure_Pa;
    for (int i = 0; i < 4000; ++i) {
        plant.advance_pressure(kPressure_Pa, kPressure_Pa);
        for (int k = 0; k < 20; ++k) truth.step(torque_Nm, 5e-5);
        if (i % 100 != 0) continue;
        CHECK(plant.wheel().v_mps == Approx(R_f * truth.omega_f).epsilon(1e-6));
        CHECK(plant.wheel().omega_radps == Approx(truth.omega).epsilon(1e-6));
    }
    const double r = plant.forces().radius_m;
    // Slip is small and steady: (m + J / r^2) r a = T.
    CHECK((rig.wheel.mass_kg + rig.wheel.inertia_kgm2 / (r * r)) * r * (rig.brake_on_mps - plant.wheel().v_mps) / 4.0 ==
          Approx(torque_Nm).epsilon(0.005));
}

TEST_CASE("loading device: a first-order lag on touchdown and on lift-off", "[RIG-100]") {
    const rig::RigParameters rig = endurance_rig();
    CHECK(rig.load.lag_s == Approx(0.1));
    for (const double step_s : {1e-3, 5e-3}) {
        CAPTURE(step_s);
        plant::Rig plant(rig, step_s, 1);
        CHECK(plant.forces().F_z_N == 0.0);
        plant.touch_down();
        for (int i = 1; i <= 200; ++i) {
            plant.advance_pressure(0.0, 0.0);
            CHECK(plant.forces().F_z_N == Approx(rig.load.base_N * (1.0 - std::exp(-i * step_s / 0.1))).epsilon(1e-10));
        }
        const double loaded_N = plant.forces().F_z_N;
        plant.lift_off();
        for (int i = 1; i <= 200; ++i) {
            plant.advance_pressure(0.0, 0.0);
            CHECK(plant.forces().F_z_N == Approx(loaded_N * std::exp(-i * step_s / 0.1)).epsilon(1e-9));
        }
    }
}

TEST_CASE("loading device: follows eq. (2) of a landing with its lag behind", "[RIG-100]") {
    rig::ManeuverChoice choice;
    choice.carrier = rig::Carrier::flywheel;
    const rig::RigParameters rig = rig::load_rig("config", choice).rig;
    plant::Rig plant(rig, 1e-3, 1);
    plant.start_rolling();
    for (int i = 0; i < 3000; ++i) {
        plant.advance_pressure(5e6, 5e6);
        if (i < 1000) continue;
        const plant::Forces f = plant.forces();
        const double v = plant.wheel().v_mps;
        const double wanted_N = rig.load.base_N - rig.load.lift_Ns2pm2 * v * v;
        // A ramp is followed late by the lag: dF/dt = 2 L v |dv/dt|.
        const double late_N = 0.1 * 2.0 * rig.load.lift_Ns2pm2 * v * f.F_x_N / rig.wheel.mass_kg;
        CHECK(wanted_N - f.F_z_N == Approx(late_N).epsilon(0.1));
    }
    const double start_J = 0.5 * rig.wheel.mass_kg * rig.brake_on_mps * rig.brake_on_mps;
    const double r_0 =
        rig.wheel.free_radius_m - (rig.load.base_N - rig.load.lift_Ns2pm2 * rig.brake_on_mps * rig.brake_on_mps) / rig.wheel.stiffness_Npm;
    const double start_wheel_J = 0.5 * rig.wheel.inertia_kgm2 * std::pow(rig.brake_on_mps / r_0, 2);
    const double lost = start_J + start_wheel_J - plant.kinetic_energy_J();
    CHECK(std::abs(lost - plant.wheel().energy_brake_J - plant.wheel().energy_tyre_J) <= 1e-6 * lost);
}

TEST_CASE("endurance: spinning the wheel up leaves the flywheel at the campaign's speed", "[RIG-100]") {
    const rig::RigParameters rig = endurance_rig();
    plant::Rig plant(rig, 1e-3, 1);
    CHECK(plant.wheel().v_mps > rig.brake_on_mps + 1.0);
    plant.touch_down();
    for (int i = 0; i < 1000; ++i) plant.advance_pressure(0.0, 0.0);
    CHECK(std::abs(plant.wheel().v_mps - 54.86) <= 0.18);
    CHECK(plant.forces().slip < 1e-3);
}

TEST_CASE("endurance: one stop meets Table III within a standard deviation", "[RIG-100]") {
    plant_sim::StopOptions options;
    options.choice.maneuver = rig::kEndurance;
    options.law = "deceleration";
    const plant_sim::StopInputs s = plant_sim::load_scenario(options);
    const study::RunResult result = study::run_in_process(s.controller, s.layout, s.plant.rig, s.session, study::Link::rounded);
    const study::StopFigures& f = result.figures;
    CHECK(f.standstill);
    CHECK(std::abs(f.mean_torque_Nm - 630.37) <= 4.65);
    CHECK(std::abs(f.mean_load_N - 23532.78) <= 198.90);
    CHECK(std::abs(f.duration_s - 16.92) <= 0.19);
    CHECK(std::abs(f.stop_distance_m - 464.22) <= 5.46);
    CHECK(std::abs(f.mean_friction / 0.30 - 1.0) <= 0.02);
    CHECK(std::abs(f.energy_residual) <= 1e-6);
}
