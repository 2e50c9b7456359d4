/// The wheel that locks, is held and spins up again, and what must be true of any wheel at any time.
#include <algorithm>
#include <cmath>

#include "tests/catch.hpp"
#include "tests/model/reference/profiles.hpp"
#include "tests/model/scenarios.hpp"

namespace {

plant::Wheel wheel_of(const rig::RigParameters& rig) {
    return plant::Wheel(rig.wheel, plant::BrakeTorque(rig.brake, rig.friction_curve, rig.mean_friction, rig.brake_on_mps), rig.surface);
}

}  // namespace

TEST_CASE("a locked wheel holds exactly, gives the brake no energy, and spins up after release", "[RIG-050]") {
    for (const NamedScenario& s : all_scenarios()) {
        CAPTURE(s.name);
        plant::Rig rig(s.loaded.rig, 1e-3, 1);
        rig.start_rolling();
        const double hard_Pa = 2.5 * min_peak_pressure_Pa(s.loaded.rig);
        int steps = 0;
        while (!rig.wheel().held && steps < 20000) {
            rig.advance_pressure(hard_Pa, hard_Pa);
            ++steps;
            REQUIRE(rig.wheel().omega_radps >= 0.0);
        }
        REQUIRE(rig.wheel().held);
        const double at_lock_J = rig.wheel().energy_brake_J;
        for (int i = 0; i < 300; ++i) {
            const plant::WheelState before = rig.wheel();
            rig.advance_pressure(hard_Pa, hard_Pa);
            REQUIRE(rig.wheel().held);
            REQUIRE(rig.wheel().omega_radps == 0.0);
            REQUIRE(rig.wheel().angle_rad == before.angle_rad);
            REQUIRE(rig.wheel().v_mps < before.v_mps);
            const plant::Forces f = rig.forces();
            REQUIRE(f.slip == Approx(1.0).epsilon(1e-15));
            REQUIRE(f.brake_torque_Nm == Approx(f.radius_m * f.F_x_N).epsilon(1e-14));
        }
        CHECK(rig.wheel().energy_brake_J == at_lock_J);
        double last_omega = 0.0;
        for (int i = 0; i < 4000 && rig.forces().slip > 0.01; ++i) {
            rig.advance_pressure(0.0, 0.0);
            CHECK(rig.wheel().omega_radps > last_omega);
            last_omega = rig.wheel().omega_radps;
        }
        CHECK_FALSE(rig.wheel().held);
        CHECK(rig.forces().slip <= 0.01);
    }
}

TEST_CASE("a locked wheel decelerates as sliding friction says", "[RIG-050]") {
    // mu(1) is constant, so v_dot = -(mu / m) (m g - L v^2) has the closed solution v = a tanh(...) of a Riccati equation.
    for (const NamedScenario& s : all_scenarios()) {
        const rig::RigParameters& rig = s.loaded.rig;
        plant::Wheel wheel = wheel_of(rig);
        const plant::LoadArc load{rig.load.base_N, 0.0, rig.load.lift_Ns2pm2};
        plant::WheelState state;
        state.v_mps = 30.0;
        const double mu = rig::friction(rig.surface, 1.0).mu;
        const double a = std::sqrt(load.base_N / load.lift_Ns2pm2);
        const double k = mu / rig.wheel.mass_kg * std::sqrt(load.base_N * load.lift_Ns2pm2);
        for (int i = 0; i < 1000; ++i) wheel.advance(state, plant::PressureArc::linear(2e7, 2e7), load, 1e-3);
        CAPTURE(s.name);
        CHECK(state.held);
        CHECK(state.v_mps == Approx(a * std::tanh(std::atanh(30.0 / a) - k * 1.0)).epsilon(1e-12));
        // Distance: the integral of that.
        const double u0 = std::atanh(30.0 / a);
        CHECK(state.distance_m == Approx(a / k * std::log(std::cosh(u0) / std::cosh(u0 - k))).epsilon(1e-10));
        CHECK(state.friction_distance_m == Approx(mu * state.distance_m).epsilon(1e-12));
    }
}

TEST_CASE("in the air the brake stops the wheel and does not turn it back; the speed stays", "[RIG-050]") {
    const rig::RigParameters parameters = rig::load_rig("config", {}).rig;
    plant::Rig rig(parameters, 1e-3, 1);
    rig.start_rolling();
    for (int i = 0; i < 100; ++i) rig.advance_pressure(0.0, 0.0);
    rig.lift_off();
    const double v = rig.wheel().v_mps;
    const double omega = rig.wheel().omega_radps;
    for (int i = 0; i < 500; ++i) rig.advance_pressure(0.0, 0.0);
    CHECK(rig.wheel().v_mps == v);
    CHECK(rig.wheel().omega_radps == omega);
    for (int i = 0; i < 1000; ++i) {
        rig.advance_pressure(2e6, 2e6);
        REQUIRE(rig.wheel().omega_radps >= 0.0);
    }
    CHECK(rig.wheel().held);
    CHECK(rig.wheel().omega_radps == 0.0);
    CHECK(rig.wheel().v_mps == v);
    // The brake took what the wheel had.
    CHECK(rig.wheel().energy_brake_J == Approx(0.5 * parameters.wheel.inertia_kgm2 * omega * omega).epsilon(1e-6));
    rig.touch_down();
    for (int i = 0; i < 300; ++i) rig.advance_pressure(0.0, 0.0);
    CHECK(rig.forces().slip < 0.01);
}

TEST_CASE("any state, any input: finite, no energy from nothing, no wheel turning back, no time lost", "[RIG-001]") {
    rig::Random random(20260102);
    const auto share = [&] { return static_cast<double>(random.bits() >> 11U) * 0x1p-53; };
    const auto scenarios = all_scenarios();
    double worst_residual = 0.0;
    for (int run = 0; run < 20000; ++run) {
        const rig::RigParameters& rig = scenarios.at(random.bits() % scenarios.size()).loaded.rig;
        plant::Wheel wheel = wheel_of(rig);
        const bool air = share() < 0.1;
        const plant::LoadArc load = air ? plant::LoadArc{} : plant::LoadArc{rig.load.base_N, 0.0, rig.load.lift_Ns2pm2};
        plant::WheelState state;
        // Speeds of every size, many of them low.
        state.v_mps = rig.brake_on_mps * std::pow(share(), 3.0) + 0.051;
        state.omega_radps = share() < 0.2 ? 0.0 : state.v_mps / 0.33 * 1.5 * share();
        state.held = state.omega_radps == 0.0;
        const double full_Pa = share() < 0.5 ? 2.07e7 : 3e6;
        double from = full_Pa * share();
        for (int i = 0; i < 25; ++i) {
            const double h = share() < 0.5 ? 1e-3 : 1e-4 * (1.0 + 49.0 * share());
            if (share() < 0.2) from = share() < 0.5 ? 0.0 : full_Pa * share();
            const double to = share() < 0.3 ? from : full_Pa * share();
            const plant::WheelState before = state;
            wheel.advance(state, plant::PressureArc::linear(from, to), load, h);
            CAPTURE(run, i, rig.surface.name, air, h, from, to, before.v_mps, before.omega_radps, before.held, state.v_mps, state.omega_radps);
            from = to;
            const double energy_before = wheel.kinetic_energy_J(before);
            REQUIRE(std::isfinite(state.v_mps));
            REQUIRE(std::isfinite(state.omega_radps));
            REQUIRE(state.omega_radps >= 0.0);
            REQUIRE(state.v_mps >= 0.0);
            const double r = wheel.forces(before, 0.0, load).radius_m;
            // Only a wheel that turns too fast can push.
            if (before.omega_radps * r <= before.v_mps) REQUIRE(state.v_mps <= before.v_mps);
            // Of what there is; at walking pace, where a step holds hundreds of the wheel's time constants, of the whole stop's energy.
            const double scale_J = before.v_mps > 5.0 ? energy_before : 0.5 * rig.wheel.mass_kg * rig.brake_on_mps * rig.brake_on_mps;
            const double tiny_J = 1e-9 * scale_J;
            REQUIRE(wheel.kinetic_energy_J(state) <= energy_before + tiny_J);
            REQUIRE(state.energy_brake_J >= before.energy_brake_J - tiny_J);
            REQUIRE(state.energy_tyre_J >= before.energy_tyre_J - tiny_J);
            const double lost = energy_before - wheel.kinetic_energy_J(state);
            const double spent = state.energy_brake_J - before.energy_brake_J + state.energy_tyre_J - before.energy_tyre_J;
            worst_residual = std::max(worst_residual, std::abs(lost - spent) / scale_J);
            REQUIRE(std::abs(lost - spent) <= 1e-6 * scale_J);
            if (state.held) REQUIRE(state.omega_radps == 0.0);
            // The whole step was made: distance is speed times time.
            if (state.v_mps > 0.06) {
                const double low = std::min(before.v_mps, state.v_mps);
                const double high = std::max(before.v_mps, state.v_mps);
                REQUIRE(state.distance_m - before.distance_m >= h * low * (1.0 - 1e-6));
                if (before.omega_radps * r <= before.v_mps) REQUIRE(state.distance_m - before.distance_m <= h * high * (1.0 + 1e-6));
            }
            if (state.v_mps <= plant::Wheel::kSlowest_mps) break;
        }
    }
    SUCCEED("worst energy residual of one step " << worst_residual);
}

TEST_CASE("a load that drifts is followed: energies close, steps of any size agree", "[RIG-001]") {
    const rig::RigParameters rig = rig::load_rig("config", {}).rig;
    const double pressure_Pa = 0.6 * min_peak_pressure_Pa(rig);
    const auto run = [&](double h) {
        plant::Wheel wheel = wheel_of(rig);
        plant::WheelState state;
        state.v_mps = 40.0;
        state.omega_radps = 40.0 / 0.32;
        state.held = false;
        double load_N = 20000.0;
        const double start_J = wheel.kinetic_energy_J(state);
        for (int i = 0; i < std::lround(1.0 / h); ++i) {
            // 10 kN up and down in half a second each: the sledge of a rig at work.
            const double next_N = 20000.0 + 10000.0 * std::min(2.0 * (i + 1) * h, 2.0 - 2.0 * (i + 1) * h);
            wheel.advance(state, plant::PressureArc::linear(pressure_Pa, pressure_Pa), {load_N, next_N - load_N, 0.0}, h);
            load_N = next_N;
        }
        const double lost = start_J - wheel.kinetic_energy_J(state);
        CHECK(std::abs(lost - state.energy_brake_J - state.energy_tyre_J) <= 1e-6 * lost);
        return state;
    };
    const plant::WheelState fine = run(1e-4);
    for (const double h : {1e-3, 5e-3}) {
        const plant::WheelState coarse = run(h);
        CHECK(coarse.v_mps == Approx(fine.v_mps).epsilon(1e-6));
        CHECK(coarse.omega_radps == Approx(fine.omega_radps).epsilon(1e-6));
        CHECK(coarse.energy_tyre_J == Approx(fine.energy_tyre_J).epsilon(1e-5));
    }
}

TEST_CASE("what the wheel remembers between steps changes no bit", "[RIG-001]") {
    const rig::RigParameters rig = rig::load_rig("config", {}).rig;
    const plant::LoadArc load{rig.load.base_N, 0.0, rig.load.lift_Ns2pm2};
    plant::Wheel remembering = wheel_of(rig);
    plant::WheelState a;
    a.v_mps = rig.brake_on_mps;
    plant::WheelState b = a;
    rig::Random random(3);
    double from = 0.0;
    for (int i = 0; i < 6000; ++i) {
        const double to = std::clamp(from + 3e5 * random.noise(), 0.0, 1.4e7);
        const auto arc = plant::PressureArc::linear(from, to);
        from = to;
        remembering.advance(a, arc, load, 1e-3);
        wheel_of(rig).advance(b, arc, load, 1e-3);
        REQUIRE(a.v_mps == b.v_mps);
        REQUIRE(a.omega_radps == b.omega_radps);
        REQUIRE(a.energy_tyre_J == b.energy_tyre_J);
        const plant::Forces f = remembering.forces(a, to, load);
        const plant::Forces fresh = wheel_of(rig).forces(b, to, load);
        REQUIRE(f.slip == fresh.slip);
        REQUIRE(f.F_x_N == fresh.F_x_N);
        REQUIRE(f.brake_torque_Nm == fresh.brake_torque_Nm);
    }
}
