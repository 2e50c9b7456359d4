// What the brake takes while encoders, or all sensors, are silent.
#include <algorithm>
#include <cstdio>
#include <iterator>

#include "rig_bridge/record/bus_meter.hpp"
#include "tests/catch.hpp"
#include "tests/record/closed_form.hpp"

using namespace record_test;
using antiskid::can::Role;
using rig::record::BusMeter;

namespace {

constexpr double kAbort_s = 4.3;

/// Frames of `roles` do not come from `from_s` to `to_s`.
struct Silence {
    std::vector<Role> roles;
    double from_s = 0.0, to_s = 1e9;
};
const std::vector<Role> kEncoders{Role::wheel, Role::flywheel};
const std::vector<Role> kSensors{Role::wheel, Role::flywheel, Role::pressure, Role::sync};

BusMeter metered(const ClosedForm& c, bool sync, const Silence& silence, const Recording::Change& change = {}) {
    BusMeter meter(can_test::ours(), gated());
    const Recording recording(c, sync, 1, change);
    for (const Frame& frame : recording.frames) {
        const double t = 1e-9 * static_cast<double>((frame.received - recording.frames.front().received).count());
        const bool of_them = std::any_of(silence.roles.begin(), silence.roles.end(), [&](Role r) { return frame.id == can_test::ours()[r].id; });
        if (!of_them || t < silence.from_s || t > silence.to_s) meter.accept(frame);
    }
    return meter;
}

double kinetic_J(const ClosedForm& c, double v_mps) {
    const double wheel_radps = v_mps * (1.0 - c.slip) / c.radius_m();
    return 0.5 * (kRig.flywheel_mass_kg * v_mps * v_mps + kRig.wheel_inertia_kgm2 * wheel_radps * wheel_radps);
}

/// From brake-on to a speed.
double brake_J(const ClosedForm& c, double v_mps) {
    return c.torque_Nm * (1.0 - c.slip) / c.radius_m() * (c.v0_mps * c.v0_mps - v_mps * v_mps) / (2.0 * c.a1_mps2);
}

/// At kAbort_s; the brake lets go 0.2 s later, as PLC and valve say; what lasts is the flywheel's deceleration.
void aborted(double t, RigSample& sample) {
    if (t > kAbort_s) sample.maneuver_state.phase = 9;
    if (t > kAbort_s + 0.2) sample.pressure_Pa = sample.load_cells.brake_torque_Nm = sample.load_cells.longitudinal_N = 0.0F;
}

std::vector<std::string> names(const std::vector<std::string>& warnings) {
    std::vector<std::string> all;
    std::transform(warnings.begin(), warnings.end(), std::back_inserter(all), [](const std::string& one) { return one.substr(0, one.find(':')); });
    return all;
}

}  // namespace

TEST_CASE("while encoders are silent the speeds before and after say what the brake took", "[BRG-200]") {
    const ClosedForm c;
    for (const bool sync : {true, false}) {
        for (const std::vector<Role>& roles : {kEncoders, kSensors, {Role::flywheel}, {Role::wheel}}) {
            for (const auto& [from_s, to_s] : {std::pair{1.9, 2.4}, std::pair{2.3, 2.9}, std::pair{5.0, 9.0}, std::pair{12.0, 16.0}}) {
                CAPTURE(sync, roles.size(), static_cast<int>(roles[0]), from_s, to_s);
                const BusMeter meter = metered(c, sync, {roles, from_s, to_s});
                CHECK(meter.figures().energy_brake_J == Approx(brake_J(c, 0.0)).epsilon(0.015));
                CHECK(names(meter.warnings()) == std::vector<std::string>{"energy_by_speeds"});
            }
        }
    }
}

TEST_CASE("what a brake took that was released unheard counts as soon as the flywheel is heard again", "[BRG-200][BRG-261]") {
    const ClosedForm c;
    constexpr double kHeard_s = 6.0;
    for (const std::vector<Role>& roles : {kEncoders, kSensors}) {
        // Before the brake comes on, in braking, and just before the abort.
        for (const double from_s : {1.9, 4.0, 4.25}) {
            CAPTURE(roles.size(), from_s);
            const BusMeter meter = metered(c, true, {roles, from_s, kHeard_s}, aborted);
            const double most_J = brake_J(c, c.speed(kHeard_s + 0.1));
            CHECK(meter.figures().energy_brake_J < 1.005 * most_J);
            CHECK(meter.figures().energy_brake_J > 0.995 * brake_J(c, c.speed(kHeard_s)));
            CHECK(names(meter.warnings()) == std::vector<std::string>{"energy_by_speeds"});
        }
    }
}

TEST_CASE("what load cells said before the brake came on is not its torque while the PLC stands still", "[BRG-200]") {
    ClosedForm c;
    const double shorter = 8.1 / c.a1_mps2;
    c.v0_mps = 25.0;
    c.a1_mps2 = c.a2_mps2 = 8.1;
    c.torque_Nm *= shorter;
    c.force_N *= shorter;
    constexpr double kStands_s = 0.299;                        // just below plc_timeout_ms: nothing is aborted
    constexpr double kSaidAgain_s = rig::record::kRepeated_s;  // by the bridge
    for (const double from_s : {1.91, 1.95, 1.99}) {
        CAPTURE(from_s);
        const auto stands = [=](double t, RigSample& sample) {
            if (t > from_s && t < from_s + kStands_s) sample.load_cells.brake_torque_Nm = sample.load_cells.longitudinal_N = 0.0F;
        };
        const BusMeter meter = metered(c, true, {{Role::load_cells}, from_s + kSaidAgain_s, from_s + kStands_s}, stands);
        CHECK(meter.figures().energy_brake_J == Approx(brake_J(c, 0.0)).epsilon(0.015));
        CHECK(names(meter.warnings()) == std::vector<std::string>{"energy_by_speeds"});
        // Said again for as long as the PLC stands, it counts: no record tells it from a brake that lets go.
        CHECK(metered(c, true, {}, stands).figures().energy_brake_J < 0.95 * brake_J(c, 0.0));
    }
}

TEST_CASE("a record that ends before a braking flywheel is heard again names the most that is not in it", "[BRG-261]") {
    const ClosedForm c;
    for (const std::vector<Role>& roles : {kEncoders, kSensors}) {
        for (const double from_s : {1.9, 4.0, 4.25}) {
            CAPTURE(roles.size(), from_s);
            const BusMeter meter = metered(c, true, {roles, from_s}, aborted);
            CHECK(meter.open());
            const double v_mps = c.speed(from_s);
            double at_mps = 0.0, most_MJ = 0.0;
            CHECK(std::sscanf(meter.warnings().back().c_str(),
                              "ends_unheard: at %lg m/s, and the brake may have taken up to %lg MJ that are in no record", &at_mps, &most_MJ) == 2);
            CHECK(at_mps == Approx(v_mps).margin(0.1));
            CHECK(most_MJ == Approx(1e-6 * kinetic_J(c, v_mps)).epsilon(0.01));
            CHECK(meter.figures().energy_brake_J == Approx(brake_J(c, v_mps)).margin(0.01 * brake_J(c, 0.0)));
        }
    }
    // The brake was seen released: nothing is open.
    CHECK(metered(c, true, {kSensors, kAbort_s + 0.4}, aborted).warnings().empty());
    CHECK_FALSE(metered(c, true, {}).open());
}
