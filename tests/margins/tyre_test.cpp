/// The linearised wheel on a tyre that gives way, against the plant's own nonlinear one and against the rigid wheel that it becomes.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant_sim/model/compliant_wheel.hpp"
#include "plant_sim/study/margins/dense.hpp"
#include "plant_sim/study/margins/law_loop.hpp"
#include "plant_sim/study/margins/linear_wheel.hpp"
#include "plant_sim/study/margins/margins.hpp"
#include "plant_sim/study/margins/margins_settings.hpp"
#include "plant_sim/study/margins/pid_loop.hpp"
#include "tests/catch.hpp"
#include "tests/margins/frequency_response.hpp"
#include "tests/margins/scenario.hpp"

using namespace study::margins;
using margins_test::scenario;

namespace {

/// Nothing slows it down: speed stays what it is.
constexpr double kNoAircraft_kg = 1e12;

/// q of linear_wheel.hpp by 1 Pa.
double per_pressure(const OperatingPoint& at) {
    return at.radius_m * at.brake_gain_m3 / (at.inertia_kgm2 * at.speed_mps);
}

/// The plant's wheel about an operating point, its brake pressed as a test says.
class RealWheel {
  public:
    RealWheel(const rig::RigParameters& rig, const OperatingPoint& at)
        : at_(at),
          wheel_(rig.wheel, plant::BrakeTorque(rig.brake, rig.friction_curve, rig.mean_friction, rig.brake_on_mps), rig.surface.law(), 1e-11),
          state_{.v_mps = at.speed_mps, .omega_radps = (1.0 - at.slip) * at.speed_mps / at.radius_m, .held = false} {
        wheel_.settle(state_);
    }
    void press(double pressure_Pa, double seconds) {
        wheel_.advance(state_, plant::PressureArc::linear(pressure_Pa, pressure_Pa), {at_.load_N, 0.0, 0.0}, seconds);
    }
    [[nodiscard]] double slip() const { return 1.0 - state_.omega_radps * at_.radius_m / at_.speed_mps; }
    /// Comes to the equilibrium, a stable one or not: the brake gives way to slip by `gain_per_s` in slip rate.
    void settle(double gain_per_s) {
        for (int i = 0; i < 20000; ++i) press(at_.pressure_Pa - gain_per_s * (slip() - at_.slip) / per_pressure(at_), 5e-5);
    }

  private:
    OperatingPoint at_;
    plant::CompliantWheel wheel_;
    plant::WheelState state_;
};

struct Case {
    const char* what = "";
    const char* surface = "";
    double speed_mps = 0.0, slip = 0.0;
    rig::Compliance tyre;
};
const std::vector<Case> kBeforePeak{{"soft ring", "dry_asphalt", 40.0, 0.10, {.ring = {0.45, 50.0, 0.03}, .relaxation = {}, .leg = {}}},
                                    {"stiff ring", "wet_asphalt", 20.0, 0.08, {.ring = {0.25, 120.0, 0.10}, .relaxation = {}, .leg = {}}},
                                    {"belt held by the road", "dry_cobblestone", 8.0, 0.2, {.ring = {0.35, 80.0, 0.06}, .relaxation = {}, .leg = {}}},
                                    {"relaxation", "dry_asphalt", 30.0, 0.08, {.ring = {}, .relaxation = {0.3, 0.02}, .leg = {}}},
                                    {"both", "dry_asphalt", 30.0, 0.08, {.ring = {0.35, 80.0, 0.06}, .relaxation = {0.2, 0.05}, .leg = {}}}};
const std::vector<Case> kBeyondPeak{
    {"ring that excites itself", "dry_asphalt", 25.0, 0.30, {.ring = {0.35, 80.0, 0.03}, .relaxation = {}, .leg = {}}},
    {"ring that does not", "wet_asphalt", 45.0, 0.24, {.ring = {0.45, 120.0, 0.10}, .relaxation = {}, .leg = {}}},
    {"relaxation at its floor", "dry_concrete", 30.0, 0.30, {.ring = {}, .relaxation = {0.3, 0.05}, .leg = {}}}};

rig::RigParameters rig_of(const Case& c, double mass_kg) {
    rig::RigParameters rig = scenario(c.surface, "medium_a").plant.rig;
    rig.wheel.compliance = c.tyre;
    rig.wheel.mass_kg = mass_kg;
    return rig;
}

/// A tyre that gives way at frequencies and lengths beyond all that matters.
const std::vector<rig::Compliance> kNearlyRigid{{.ring = {0.35, 2e5, 1.0}, .relaxation = {}, .leg = {}},
                                                {.ring = {}, .relaxation = {1e-6, 1e-6}, .leg = {}}};

}  // namespace

TEST_CASE("rim's slip against brake torque: the frequency response of the plant's own wheel", "[STUDY-123]") {
    for (const Case& c : kBeforePeak) {
        const rig::RigParameters rig = rig_of(c, kNoAircraft_kg);
        const OperatingPoint at = operating_point(rig, c.speed_mps, c.slip);
        const LinearWheel wheel = linear_wheel(at, Linearisation::full);
        for (const double frequency_Hz : {5.0, 25.0, 50.0, 90.0, 150.0}) {
            constexpr int kSteps = 400;  // a turn
            const double h = 1.0 / (frequency_Hz * kSteps), w = 2.0 * std::numbers::pi * frequency_Hz;
            const double amplitude_Pa = 1e-4 * at.pressure_Pa;
            RealWheel real(rig, at);
            real.settle(4.0 * std::abs(at.wheel_pole_radps(Linearisation::full)));
            const int settle = static_cast<int>(std::ceil(0.5 * frequency_Hz));
            Complex measured = 0.0;
            constexpr int kTurns = 3;
            for (int i = -settle * kSteps; i < kTurns * kSteps; ++i) {
                // A pressure that is held over a step is that of its middle, less a millionth.
                real.press(at.pressure_Pa + amplitude_Pa * std::sin(w * h * (i + 0.5)), h);
                if (i >= 0) measured += (real.slip() - at.slip) * std::polar(2.0 / (kTurns * kSteps), -w * h * (i + 1));
            }
            measured *= Complex(0.0, 1.0) / amplitude_Pa;
            const Eigen::Index n = wheel.a.rows();
            const Eigen::MatrixXcd of = (Complex(0.0, w) * Eigen::MatrixXcd::Identity(n, n) - wheel.a.cast<Complex>()).inverse();
            const Complex computed = per_pressure(at) * wheel.gain * of(0, 0);
            INFO(c.what << " at " << frequency_Hz << " Hz: measured " << measured << ", computed " << computed);
            CHECK(std::abs(measured / computed - 1.0) < 2e-3);
            // The same by poles and zeros.
            Complex product = per_pressure(at) * wheel.gain;
            for (const Complex& z : wheel.zeros()) product *= Complex(0.0, w) - z;
            for (const Complex& p : wheel.poles()) product /= Complex(0.0, w) - p;
            CHECK(std::abs(product / computed - 1.0) < 1e-9);
        }
    }
}

TEST_CASE("beyond the peak the plant's own wheel leaves its equilibrium as the linearised one does", "[STUDY-123]") {
    for (const Case& c : kBeyondPeak) {
        const rig::RigParameters rig = rig_of(c, kNoAircraft_kg);
        const OperatingPoint at = operating_point(rig, c.speed_mps, c.slip);
        const LinearWheel wheel = linear_wheel(at, Linearisation::full);
        RealWheel left(rig, at);
        left.settle(4.0 * std::abs(at.wheel_pole_radps(Linearisation::full)));
        INFO(c.what << ": settled at " << left.slip() << " instead of " << at.slip);
        REQUIRE(std::abs(left.slip() - at.slip) < 1e-6);
        RealWheel pressed = left;
        const double kick_Pa = 1e-6 * at.pressure_Pa, h = 1e-4;
        const Eigen::Index n = wheel.a.rows();
        Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + 1, n + 1);
        system.topLeftCorner(n, n) = wheel.a;
        system(0, n) = wheel.gain * per_pressure(at) * kick_Pa;
        const Eigen::MatrixXd over_h = exponential(system * h);
        Eigen::VectorXd x = Eigen::VectorXd::Zero(n + 1);
        x[n] = 1.0;
        double max = 0.0, furthest = 0.0;
        for (int i = 0; i < 400; ++i) {
            left.press(at.pressure_Pa, h);
            pressed.press(at.pressure_Pa + kick_Pa, h);
            x = (over_h * x).eval();
            max = std::max(max, std::abs(pressed.slip() - left.slip() - x[0]));
            furthest = std::max(furthest, std::abs(x[0]));
        }
        INFO("wrong by " << max << " of " << furthest);
        CHECK(max < 5e-3 * furthest);
    }
    const auto swing = [](const Case& c) {
        return linear_wheel(operating_point(rig_of(c, kNoAircraft_kg), c.speed_mps, c.slip), Linearisation::full).swing();
    };
    CHECK(swing(kBeyondPeak[0]).value().real() > 1.0);
    CHECK(swing(kBeyondPeak[1]).value().real() < 0.0);
    CHECK_FALSE(swing(kBeyondPeak[2]));
}

TEST_CASE("a tyre that hardly gives way has the rigid one's margins", "[STUDY-123]") {
    const plant_sim::StopInputs s = scenario("dry_asphalt", "medium_a");
    const Pid pid = load_margins_settings("config/margins.toml").pid;
    for (const rig::Compliance& tyre : kNearlyRigid) {
        rig::RigParameters rig = s.plant.rig;
        rig.wheel.compliance = tyre;
        for (const double v : {48.0, 30.0, 12.0}) {
            const double slip = scheduled_slip(s.controller.slip, 0.24, v);
            const OperatingPoint at = operating_point(rig, v, slip), rigid = operating_point(s.plant.rig, v, slip);
            for (const auto linearisation : {Linearisation::printed, Linearisation::full}) {
                INFO(v << " m/s, belt " << tyre.ring.belt_share);
                const auto poles = linear_wheel(at, linearisation).poles();
                const double a = rigid.wheel_pole_radps(linearisation);
                CHECK(std::any_of(poles.begin(), poles.end(), [a](Complex p) { return std::abs(p + a) < 2e-4 * std::abs(a); }));
                const auto same = [](const Margins& m, const Margins& expected) {
                    REQUIRE(expected.stable);
                    REQUIRE(m.stable);
                    CHECK(m.phase_deg == Approx(expected.phase_deg).margin(5e-3));
                    CHECK(m.gain_up_dB == Approx(expected.gain_up_dB).margin(2e-3));
                    CHECK(m.crossover_radps == Approx(expected.crossover_radps).epsilon(1e-3));
                };
                same(margins(SampledLoop(law_system(s.controller, rig, at, linearisation))),
                     margins(SampledLoop(law_system(s.controller, s.plant.rig, rigid, linearisation))));
                same(margins(pid_loop(pid, rig.valve, at, linearisation)), margins(pid_loop(pid, rig.valve, rigid, linearisation)));
            }
        }
    }
}

TEST_CASE("the real estimator and law on the plant's own ring: the loop that a frequency analyser measures", "[STUDY-123]") {
    // As near as on the rigid wheel (law_loop_test.cpp), up to two thirds of the ring's frequency: at its resonance a percent of frequency
    // is ten of L.
    struct Ring {
        const char* surface = "";
        double speed_mps = 0.0, slip = 0.0;
        rig::RingParameters ring;
    };
    for (const Ring& r : {Ring{"dry_asphalt", 46.0, 0.12, {0.25, 120.0, 0.10}}, Ring{"dry_asphalt", 46.0, 0.12, {0.35, 80.0, 0.06}},
                          Ring{"dry_asphalt", 46.0, 0.12, {0.45, 50.0, 0.10}}}) {
        const plant_sim::StopInputs s = scenario(r.surface, "medium_a");
        rig::RigParameters rig = s.plant.rig;
        rig.wheel.compliance.ring = r.ring;
        rig.wheel.mass_kg = kNoAircraft_kg;
        const OperatingPoint at = operating_point(rig, r.speed_mps, r.slip);
        antiskid::control::Config config = s.controller;
        config.observer.pole_noise = 0.0F;
        config.observer.pole_floor_radps = static_cast<float>(2.0 * at.wheel_pole_radps(Linearisation::full));
        config.slip.runaway_per_s = 1e3F;
        const SampledLoop loop(law_system(config, rig, at, Linearisation::full));
        REQUIRE(margins(loop).stable);
        margins_test::FrozenStop stop(config, rig, at);
        REQUIRE(std::abs(stop.slip() - at.slip) < 1e-3);
        for (const double w : {15.0, 40.0, 100.0, 200.0, 300.0}) {
            if (w > 2.0 / 3.0 * 2.0 * std::numbers::pi * r.ring.frequency_Hz) continue;
            double frequency = w;
            const Complex measured = stop.loop(frequency, 2e4, 1.0);
            const Complex computed = loop.response(frequency);
            INFO(r.surface << ", " << r.speed_mps << " m/s, ring of " << r.ring.frequency_Hz << " Hz, " << frequency << " rad/s: measured "
                           << measured << ", computed " << computed);
            CHECK(std::abs(measured - computed) < 0.05 * std::max(1.0, std::abs(computed)));
        }
    }
}
