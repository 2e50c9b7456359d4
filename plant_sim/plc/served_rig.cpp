#include "plant_sim/plc/served_rig.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "plant_sim/plc/speed_sample.hpp"

namespace plc {

using rig::Interlock;
using rig::Measured;

namespace {

constexpr double kStep_s = 1e-3;
constexpr int kStepsPerScan = 10;
static_assert(kStepsPerScan * kStep_s == ServedRig::kScan_s);

int steps_per_period(double period_s) {
    const double steps = period_s / kStep_s;
    if (!(steps >= 0.999) || std::abs(steps - std::round(steps)) > 1e-6)
        throw std::invalid_argument("the rig's period must be a whole number of milliseconds");
    return static_cast<int>(std::lround(steps));
}

PlcLimits limits(const ServedRigOptions& options) {
    const Machinery& m = options.machinery;
    return {.speed_max_mps = m.drive.speed_max_mps,
            .force_max_N = m.loading.force_max_N,
            .lift_max_Ns2pm2 = m.loading.lift_max_Ns2pm2,
            .watchdog_s = options.watchdog_s};
}

constexpr unsigned bit(Interlock interlock) {
    return 1U << static_cast<unsigned>(interlock);
}

}  // namespace

ServedRig::ServedRig(const rig::LoadedRig& loaded, ServedRigOptions options, std::uint64_t seed)
    : options_(std::move(options)),
      steps_per_period_(steps_per_period(options_.period_s)),
      rig_(loaded.rig, kStep_s, seed),
      plc_(limits(options_)),
      gauge_noise_(rig::Random(seed).bits()),
      brake_(options_.brake),
      temperature_C_(options_.machinery.thermal.ambient_C),
      decay_(options_.machinery.thermal.decay(kStep_s)) {
    rig_.start_at_rest(options_.rim_mps);
    measure();
}

unsigned ServedRig::interlocks() const {
    const Hydraulics& supply = options_.machinery.hydraulics;
    unsigned good = bit(Interlock::emergency_stop_clear) | bit(Interlock::guard_closed) | bit(Interlock::drive_healthy);
    if (supply.pressure_Pa >= supply.ready_Pa) good |= bit(Interlock::hydraulics_ready);
    return good & ~forced_open_;
}

void ServedRig::scan() {
    plc_.scan(commanded_, interlocks(), rig_.wheel().v_mps, rig_.time_s());
    const MachineCommands& commands = plc_.commands();
    if (commands.load)
        rig_.set_load(commands.load_base_N, commands.load_lift_Ns2pm2);
    else
        rig_.set_load(options_.machinery.loading.contact_force_N, 0.0);
}

void ServedRig::touch_down() {
    on_rim_ = true;
    ++maneuvers_;
    rig_.touch_down();
    const rig::RigParameters& p = rig_.parameters();
    const double friction = brake_ ? std::max(brake_->next_friction(), rig::min_mean_friction(p.friction_curve)) : p.mean_friction;
    // The momenta m v and J omega / r are exchanged until wheel and rim have the same speed.
    const double r = p.wheel.free_radius_m;
    const double share = p.wheel.inertia_kgm2 / (p.wheel.mass_kg * r * r);
    const plant::WheelState& now = rig_.wheel();
    const double rolling_mps = (now.v_mps + share * r * now.omega_radps) / (1.0 + share);
    if (rolling_mps > plant::Wheel::kSlowest_mps) rig_.set_brake(friction, rolling_mps);
}

void ServedRig::lift_off() {
    on_rim_ = false;
    rig_.lift_off();
    if (!brake_) return;
    const double energy_J = rig_.wheel().energy_brake_J;
    brake_->take(energy_J - accounted_J_);
    accounted_J_ = energy_J;
}

void ServedRig::set_brake_state(const wear::BrakeState& state) {
    if (!brake_) throw std::invalid_argument("this rig has no brake that wears");
    *brake_ = wear::WearingBrake(brake_->wear(), brake_->rule(), state);
    accounted_J_ = rig_.wheel().energy_brake_J;
}

void ServedRig::move_sledge() {
    const Sledge& sledge = options_.machinery.sledge;
    sledge_m_ = sledge.moved(sledge_m_, plc_.commands().advance, kStep_s);
    const bool touches = sledge_m_ >= sledge.contact_m;
    if (touches == on_rim_) return;
    if (touches)
        touch_down();
    else
        lift_off();
}

void ServedRig::run_machines() {
    const Drive& drive = options_.machinery.drive;
    const MachineCommands& commands = plc_.commands();
    const double v = rig_.wheel().v_mps;
    const rig::RigParameters& p = rig_.parameters();
    plant::OutsideForces forces;
    if (commands.drive) forces.drive_N = drive.force_N(commands.speed_mps, v, p.wheel.mass_kg, p.flywheel_radius_m);
    if (!on_rim_) {
        if (v > 0.0 || forces.drive_N > 0.0) forces.drag_N = drive.drag.force_N(v);
        if (rig_.wheel().omega_radps > 0.0) forces.wheel_drag_Nm = options_.machinery.sledge.wheel_drag_Nm;
    }
    rig_.set_outside_forces(forces);
    move_sledge();
}

void ServedRig::advance(double valve_current_mA) {
    for (int i = 0; i < steps_per_period_; ++i) {
        const bool scans = --steps_to_scan_ == 0;
        if (scans) {
            steps_to_scan_ = kStepsPerScan;
            scan();
        }
        run_machines();
        rig_.advance_current(valve_current_mA);
        const double energy_J = rig_.wheel().energy_brake_J;
        temperature_C_ = options_.machinery.thermal.after(temperature_C_, (energy_J - energy_before_J_) / kStep_s, decay_);
        energy_before_J_ = energy_J;
        if (scans) measure();
    }
}

bool ServedRig::idle() const {
    const MachineCommands& commands = plc_.commands();
    return sledge_m_ == 0.0 && !commands.drive && !commands.advance && rig_.idle();
}

double ServedRig::pass_idle(double seconds) {
    const double periods = std::floor(seconds / options_.period_s * (1.0 + 1e-12));
    if (!idle() || !(periods >= 1.0) || !std::isfinite(periods)) return 0.0;
    const double passed = periods * options_.period_s;
    const BrakeThermal& thermal = options_.machinery.thermal;
    rig_.pass_idle(passed, options_.machinery.drive.drag);
    temperature_C_ = thermal.after(temperature_C_, 0.0, thermal.decay(passed));
    plc_.pass_idle(rig_.time_s(), static_cast<std::uint64_t>(passed / kScan_s));
    measure();
    return passed;
}

antiskid::can::RigSample ServedRig::sample() const {
    const double now = rig_.time_s();
    antiskid::can::RigSample sample;
    sample.wheel = speed_sample(rig_.wheel_encoder(), now);
    sample.flywheel = speed_sample(rig_.flywheel_encoder(), now);
    sample.pressure_Pa = static_cast<float>(rig_.measured_pressure_Pa());
    return sample;
}

void ServedRig::measure() {
    const Gauges& g = options_.machinery.gauges;
    const plant::Forces f = rig_.forces();
    const unsigned good = interlocks();
    const double supply_Pa = (forced_open_ & bit(Interlock::hydraulics_ready)) != 0U ? 0.0 : options_.machinery.hydraulics.pressure_Pa;
    const auto set = [this](Measured q, double value) { rig::at(measured_, q) = value; };
    set(Measured::map_version, options_.map_version);
    set(Measured::plc_watchdog, plc_.watchdog());
    set(Measured::plc_state, static_cast<double>(plc_.state()));
    set(Measured::applied_commit, plc_.applied_commit());
    set(Measured::rejected_commit, plc_.rejected_commit());
    set(Measured::interlocks, good);
    set(Measured::sledge_position_m, sledge_m_);
    set(Measured::wheel_on_rim, on_rim_ ? 1.0 : 0.0);
    set(Measured::flywheel_speed_mps, g.speed.read(rig_.wheel().v_mps, gauge_noise_));
    set(Measured::loading_force_N, g.force.read(f.F_z_N, gauge_noise_));
    set(Measured::vertical_load_N, g.force.read(f.F_z_N, gauge_noise_));
    set(Measured::longitudinal_force_N, g.force.read(f.F_x_N, gauge_noise_));
    set(Measured::brake_torque_Nm, g.torque.read(f.brake_torque_Nm, gauge_noise_));
    set(Measured::brake_temperature_C, g.temperature.read(temperature_C_, gauge_noise_));
    set(Measured::hydraulic_pressure_Pa, g.hydraulics.read(supply_Pa, gauge_noise_));
}

}  // namespace plc
