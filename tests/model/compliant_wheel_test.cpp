/// Tyre and leg that give way, against boost::odeint on equations written down a second time, closed forms, and their own energy books.
#include "plant_sim/model/compliant_wheel.hpp"

#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "plant_sim/model/rig.hpp"
#include "tests/catch.hpp"

using namespace plant;

namespace {

constexpr double kMass_kg = 2800.0, kInertia_kgm2 = 1.3, kFree_m = 0.335, kStiffness_Npm = 2.7e6;
constexpr double kWeight_N = kMass_kg * 9.80665, kLift = 3.6, kGain_m3 = 1.04e-3;
constexpr rig::FrictionLaw kTyre{1.0686, 15.0, 0.5};

rig::WheelParameters wheel(const rig::Compliance& compliance) {
    return {.mass_kg = kMass_kg, .inertia_kgm2 = kInertia_kgm2, .free_radius_m = kFree_m, .stiffness_Npm = kStiffness_Npm, .compliance = compliance};
}

plant::BrakeTorque brake() {
    return {rig::BrakeGeometry{kGain_m3 / 0.3, 1.0, 1.0, 1.0}, rig::FrictionCurve{0.3, 0.0, 0.0, 0.0}, 0.3, 49.0};
}

/// A build-up towards the peak in 0.2 s, then a swing about it: through all that a stop does but a lock.
double pressure_Pa(double t) {
    return 4.4e6 * (1.0 - std::exp(-t / 0.06)) + 0.5e6 * std::sin(40.0 * t);
}

/// v, axle, leg, rim, twist, belt, slip of the tread; energies of brake, tyre, leg.
using Vector = std::array<double, 10>;

constexpr double kTyre_psi = 126.0;

/// Smooth, flooded, kTyre_psi, relative to kTyre's own peak, as wet_grip.hpp has it, in knots: 25.109(c)(1) at 100 and 200 psi, then gone
/// at 9 sqrt(p) knots.
double flooded_grip(double v_mps) {
    const double V = v_mps * 3600.0 / 1852.0, x = V / 100.0;
    const double at_100 = -0.0437 * x * x * x + 0.320 * x * x - 0.805 * x + 0.804;
    const double at_200 = -0.0331 * x * x * x + 0.252 * x * x - 0.658 * x + 0.692;
    const double wet = at_100 + (kTyre_psi - 100.0) / 100.0 * (at_200 - at_100);
    const double floats = 9.0 * std::sqrt(kTyre_psi);
    const double s = std::clamp((V - 0.85 * floats) / (0.15 * floats), 0.0, 1.0);
    const double left = 1.0 - s * s * (3.0 - 2.0 * s);
    const double best = std::log(kTyre.c1 * kTyre.c2 / kTyre.c3) / kTyre.c2;
    return (left * wet + (1.0 - left) * 0.05) / (kTyre.c1 * (1.0 - std::exp(-kTyre.c2 * best)) - kTyre.c3 * best);
}

constexpr rig::MagicFormula kMagic{.B = 7.0, .C = 1.7, .D = 0.9, .E = -0.6};

/// Written from the definitions of compliance.hpp, not from the code: forces first, then Newton.
struct Reference {
    rig::Compliance c;
    bool flooded = false;
    double pressure_share = 1.0;
    bool magic = false;

    void operator()(const Vector& y, Vector& dy, double t) const {
        const bool ring = c.ring.belt_share > 0.0, leg = c.leg.mass_kg > 0.0;
        const double F_z = kWeight_N - kLift * y[0] * y[0];
        const double r = kFree_m - F_z / kStiffness_Npm;
        const double axle = leg ? y[1] : y[0], belt = ring ? y[5] : y[3];
        const double kinematic = 1.0 - belt * r / axle;
        const auto mu = [this](double s) {
            if (magic) return kMagic.D * std::sin(kMagic.C * std::atan((1.0 - kMagic.E) * kMagic.B * s + kMagic.E * std::atan(kMagic.B * s)));
            return (s < 0 ? -1.0 : 1.0) * (kTyre.c1 * (1.0 - std::exp(-kTyre.c2 * std::abs(s))) - kTyre.c3 * std::abs(s));
        };
        const double slip = c.relaxation.length_m > 0.0 ? y[6] : kinematic;
        const double F_x = F_z * mu(slip) * (flooded ? flooded_grip(axle) : 1.0);
        const double T_b = kGain_m3 * pressure_share * pressure_Pa(t);
        const double pi = std::numbers::pi;
        const double J_b = kInertia_kgm2 * c.ring.belt_share, J_r = kInertia_kgm2 - J_b;
        const double w = 2 * pi * c.ring.frequency_Hz;
        const double k = w * w * J_r * J_b / kInertia_kgm2, d = 2 * c.ring.damping * w * J_r * J_b / kInertia_kgm2;
        const double S = ring ? k * y[4] + d * (y[3] - y[5]) : 0.0;
        const double w_leg = 2 * pi * c.leg.frequency_Hz, m_leg = c.leg.mass_kg;
        const double leg_N = leg ? m_leg * w_leg * (w_leg * y[2] + 2 * c.leg.damping * (y[1] - y[0])) : 0.0;
        dy[0] = leg ? leg_N / (kMass_kg - m_leg) : -F_x / kMass_kg;
        dy[1] = leg ? -(leg_N + F_x) / m_leg : 0.0;
        dy[2] = leg ? y[1] - y[0] : 0.0;
        dy[3] = ring ? -(T_b + S) / J_r : (r * F_x - T_b) / kInertia_kgm2;
        dy[4] = ring ? y[3] - y[5] : 0.0;
        dy[5] = ring ? (S + r * F_x) / J_b : 0.0;
        constexpr double d_slip = 1e-5;  // by differences, of which the fifth order is left
        const double rise = (8.0 * (mu(slip + d_slip) - mu(slip - d_slip)) - (mu(slip + 2 * d_slip) - mu(slip - 2 * d_slip))) / (12.0 * d_slip);
        const double slope = magic ? rise / (kMagic.B * kMagic.C * kMagic.D)
                                   : (kTyre.c1 * kTyre.c2 * std::exp(-kTyre.c2 * std::abs(slip)) - kTyre.c3) / (kTyre.c1 * kTyre.c2 - kTyre.c3);
        const double sigma = std::max(c.relaxation.length_m * slope, c.relaxation.floor_m);
        dy[6] = c.relaxation.length_m > 0.0 ? (axle - belt * r - axle * y[6]) / sigma : 0.0;
        dy[7] = T_b * y[3];
        dy[8] = F_x * (axle - belt * r) + (ring ? d * (y[3] - y[5]) * (y[3] - y[5]) : 0.0);
        dy[9] = leg ? 2 * c.leg.damping * w_leg * m_leg * (y[1] - y[0]) * (y[1] - y[0]) : 0.0;
    }
};

struct Case {
    const char* name;
    rig::Compliance compliance;
    bool flooded = false;
    double pressure_share = 1.0;  ///< of pressure_Pa(): a flooded road holds less
    int steps = 600;
    bool magic = false;
};
const std::vector<Case> kCases{{"ring, soft", {.ring = {0.45, 50.0, 0.03}, .relaxation = {}, .leg = {}}},
                               {"ring, stiff", {.ring = {0.25, 120.0, 0.10}, .relaxation = {}, .leg = {}}},
                               {"relaxation, short", {.ring = {}, .relaxation = {0.03, 0.02}, .leg = {}}},
                               {"relaxation, long", {.ring = {}, .relaxation = {0.6, 0.02}, .leg = {}}},
                               {"leg", {.ring = {}, .relaxation = {}, .leg = {120.0, 12.0, 0.05}}},
                               {"all at once", {.ring = {0.35, 80.0, 0.06}, .relaxation = {0.2, 0.05}, .leg = {120.0, 8.0, 0.02}}}};

const rig::Surface kFlooded{
    .name = "flooded", .c1 = kTyre.c1, .c2 = kTyre.c2, .c3 = kTyre.c3, .wet = rig::WetGrip(kTyre_psi, rig::Texture::smooth, 0.05)};
// From 95 knots, where 101 are those of hydroplaning, down to where a third more friction is back.
const std::vector<Case> kFloodedCases{
    {"static", {}, true, 0.14, 3000},
    {"ring", {.ring = {0.35, 80.0, 0.06}, .relaxation = {}, .leg = {}}, true, 0.14, 3000},
    {"all at once", {.ring = {0.35, 80.0, 0.06}, .relaxation = {0.2, 0.05}, .leg = {120.0, 8.0, 0.02}}, true, 0.14, 3000}};

const std::vector<Case> kMagicCases{
    {"static", {}, false, 1.03, 600, true},
    {"ring", {.ring = {0.35, 80.0, 0.06}, .relaxation = {}, .leg = {}}, false, 1.03, 600, true},
    {"relaxation", {.ring = {}, .relaxation = {0.3, 0.02}, .leg = {}}, false, 1.03, 600, true},
    {"all at once", {.ring = {0.35, 80.0, 0.06}, .relaxation = {0.2, 0.05}, .leg = {120.0, 8.0, 0.02}}, false, 1.03, 600, true}};

void check_against_reference(const std::vector<Case>& cases) {
    for (const Case& one : cases) {
        INFO(one.name);
        plant::WheelState state;
        state.v_mps = 49.0;
        const double F_z = kWeight_N - kLift * 49.0 * 49.0;
        state.omega_radps = 49.0 / (kFree_m - F_z / kStiffness_Npm);
        state.held = false;
        plant::CompliantWheel mine(wheel(one.compliance), brake(), one.magic ? rig::TyreCurve(kMagic) : rig::TyreCurve(kTyre));
        if (one.flooded) mine.set_surface(kFlooded, true);
        mine.settle(state);
        Vector y{state.v_mps, state.v_mps, 0.0, state.omega_radps, 0.0, state.omega_radps, 0.0, 0.0, 0.0, 0.0};

        namespace ode = boost::numeric::odeint;
        const auto stepper = ode::make_controlled(1e-12, 1e-12, ode::runge_kutta_fehlberg78<Vector>());
        const Reference reference{one.compliance, one.flooded, one.pressure_share, one.magic};
        const auto pressure = [&one](double t) { return one.pressure_share * pressure_Pa(t); };
        double worst = 0.0;
        constexpr double kStep_s = 1e-3;
        for (int i = 0; i < one.steps; ++i) {
            const double t0 = i * kStep_s, t1 = t0 + kStep_s;
            const auto rate = [&](double t) { return (pressure(t + 1e-6) - pressure(t - 1e-6)) / 2e-6; };
            const plant::PressureArc arc = plant::PressureArc::hermite(pressure(t0), rate(t0), pressure(t1), rate(t1), kStep_s);
            mine.advance(state, arc, {kWeight_N, 0.0, kLift}, kStep_s);
            ode::integrate_adaptive(stepper, reference, y, t0, t1, 1e-5);
            worst = std::max({worst, std::abs(state.v_mps / y[0] - 1.0), std::abs(state.omega_radps - y[3]) * kFree_m / y[0]});
        }
        CHECK(worst < 1e-6);
        CHECK(state.energy_brake_J == Approx(y[7]).epsilon(1e-6));
        CHECK(state.energy_tyre_J == Approx(y[8]).epsilon(1e-5));
        CHECK(mine.energy_leg_J() == Approx(y[9]).epsilon(1e-4).margin(1e-6));
        CHECK(state.omega_radps * kFree_m < (one.flooded ? 1.0 : 0.97) * state.v_mps);  // it was braked
    }
}

}  // namespace

TEST_CASE("a compliant wheel agrees with a tight reference integration", "[RIG-250]") {
    check_against_reference(kCases);
}

TEST_CASE("so does a wheel whose friction depends on speed, on a rigid and on a compliant tyre", "[RIG-262]") {
    check_against_reference(kFloodedCases);
}

TEST_CASE("so does a wheel on the friction of a magic formula, on a rigid and on a compliant tyre", "[RIG-264]") {
    check_against_reference(kMagicCases);
}

TEST_CASE("the books close where friction depends on speed, through floating, locks and releases", "[RIG-262]") {
    for (const Case& one : kFloodedCases) {
        INFO(one.name);
        plant::WheelState state;
        state.v_mps = 52.5;  // afloat
        state.omega_radps = 165.0;
        state.held = false;
        plant::CompliantWheel mine(wheel(one.compliance), brake(), kTyre);
        mine.set_surface(kFlooded, true);
        mine.settle(state);
        const double before = mine.energy_J(state);
        bool locked = false;
        for (int i = 0; i < 12000; ++i) {
            const double P = i < 500 ? 0.2e6 : (i < 8000 ? 8e6 : 0.1e6);
            mine.advance(state, plant::PressureArc::linear(P, P), {kWeight_N, 0.0, kLift}, 1e-3);
            locked = locked || (state.held && state.omega_radps == 0.0);
        }
        CHECK(locked);
        CHECK_FALSE(state.held);
        CHECK(state.v_mps < 51.5);
        const double spent = state.energy_brake_J + state.energy_tyre_J + mine.energy_leg_J();
        CHECK((before - mine.energy_J(state) - spent) / before == Approx(0.0).margin(1e-6));
    }
}

namespace {
void check_books(const Case& one) {
    INFO(one.name);
    plant::WheelState state;
    state.v_mps = 49.0;
    state.omega_radps = 150.0;
    state.held = false;
    plant::CompliantWheel mine(wheel(one.compliance), brake(), one.magic ? rig::TyreCurve(kMagic) : rig::TyreCurve(kTyre));
    mine.settle(state);
    const double before = mine.energy_J(state);
    bool locked = false;
    for (int i = 0; i < 2000; ++i) {
        const double P = i < 500 ? 4e6 : (i < 900 ? 20e6 : 2e6);
        mine.advance(state, plant::PressureArc::linear(P, P), {kWeight_N, 0.0, kLift}, 1e-3);
        locked = locked || (state.held && state.omega_radps == 0.0);
        CHECK(state.omega_radps >= 0.0);
    }
    CHECK(locked);
    CHECK_FALSE(state.held);
    const double spent = state.energy_brake_J + state.energy_tyre_J + mine.energy_leg_J();
    CHECK((before - mine.energy_J(state) - spent) / before == Approx(0.0).margin(1e-6));
}
}  // namespace

TEST_CASE("the books of a compliant wheel close, through a lock and its release, too", "[RIG-250]") {
    for (const Case& one : kCases) check_books(one);
}

TEST_CASE("they close on the friction of a magic formula", "[RIG-264]") {
    for (const Case& one : kMagicCases) check_books(one);
}

TEST_CASE("a belt that swings under a locked rim, far beyond slip 1, takes few steps", "[RIG-250]") {
    const rig::Compliance c{.ring = {0.35, 100.0, 0.03}, .relaxation = {}, .leg = {}};
    plant::CompliantWheel mine(wheel(c), brake(), kTyre);
    plant::WheelState state;
    state.v_mps = 4.0;
    state.omega_radps = 0.0;
    state.held = true;
    mine.settle(state);
    double max_slip = 0.0;
    constexpr int kMs = 150;
    for (int i = 0; i < kMs; ++i) {
        mine.advance(state, plant::PressureArc::linear(20e6, 20e6), {kWeight_N, 0.0, kLift}, 1e-3);
        const double r = kFree_m - (kWeight_N - kLift * state.v_mps * state.v_mps) / kStiffness_Npm;
        max_slip = std::max(max_slip, 1.0 - mine.belt_radps() * r / state.v_mps);
    }
    CHECK(state.held);
    CHECK(state.v_mps > 1.0);
    CHECK(max_slip > 1.2 * kTyre.c1 / kTyre.c3);  // there eq. (4) is below zero
    CHECK(mine.steps() < 60UL * kMs);
}

TEST_CASE("off the ground, rim and belt swing at the mode that was asked for, and die out as asked", "[RIG-250]") {
    const rig::Compliance c{.ring = {0.35, 70.0, 0.05}, .relaxation = {}, .leg = {}};
    plant::CompliantWheel mine(wheel(c), plant::BrakeTorque(), kTyre, 1e-10);
    plant::WheelState state;
    state.v_mps = 49.0;
    state.omega_radps = 100.0;
    state.held = false;
    mine.settle(state);
    // A push on the rim alone: settle() with another speed first, then the rim's by a stretch of brake.
    plant::CompliantWheel pushed(wheel(c), brake(), kTyre, 1e-10);
    pushed.settle(state);
    pushed.advance(state, plant::PressureArc::linear(5e6, 5e6), {}, 1e-3);
    const plant::BrakeTorque none;
    pushed.set_brake(none);
    const double w = 2.0 * std::numbers::pi * 70.0, d = 0.05;
    const double w_d = w * std::sqrt(1.0 - d * d);
    // Twist rate now and a damped period later: smaller by exp(-d w T), of the same sign.
    const auto rate = [&] { return state.omega_radps - pushed.belt_radps(); };
    const double first = rate();
    const double period = 2.0 * std::numbers::pi / w_d;
    for (int i = 0; i < 100; ++i) pushed.advance(state, {}, {}, period / 100.0);
    CHECK(rate() == Approx(first * std::exp(-d * w * period)).epsilon(1e-6));
    CHECK(state.v_mps == Approx(49.0));
}

TEST_CASE("a tyre that hardly gives way is the paper's", "[RIG-250]") {
    const rig::Compliance stiff{.ring = {0.3, 3000.0, 0.5}, .relaxation = {}, .leg = {}};
    plant::WheelState a;
    a.v_mps = 49.0;
    a.omega_radps = 150.0;
    a.held = false;
    plant::WheelState b = a;
    plant::Wheel paper(wheel({}), brake(), rig::Surface{"x", kTyre.c1, kTyre.c2, kTyre.c3});
    plant::CompliantWheel mine(wheel(stiff), brake(), kTyre);
    mine.settle(b);
    for (int i = 0; i < 500; ++i) {
        const plant::PressureArc arc = plant::PressureArc::linear(pressure_Pa(i * 1e-3), pressure_Pa((i + 1) * 1e-3));
        paper.advance(a, arc, {kWeight_N, 0.0, kLift}, 1e-3);
        mine.advance(b, arc, {kWeight_N, 0.0, kLift}, 1e-3);
    }
    CHECK(b.v_mps == Approx(a.v_mps).epsilon(1e-4));
    CHECK(b.omega_radps == Approx(a.omega_radps).epsilon(1e-3));
}

TEST_CASE("compliance that cannot be is refused", "[RIG-250]") {
    const auto rejected = [](const rig::Compliance& c) { CHECK_THROWS_AS(plant::CompliantWheel(wheel(c), brake(), kTyre), std::invalid_argument); };
    rejected({.ring = {1.0, 70.0, 0.05}, .relaxation = {}, .leg = {}});
    rejected({.ring = {0.3, 0.0, 0.05}, .relaxation = {}, .leg = {}});
    rejected({.ring = {}, .relaxation = {0.3, 0.0}, .leg = {}});
    rejected({.ring = {}, .relaxation = {}, .leg = {kMass_kg, 10.0, 0.05}});
}
