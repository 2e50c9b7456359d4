#include "rig_bridge/record/meter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <utility>

#include "firmware/can/sensor_decoder.hpp"

namespace rig::record {

namespace {

// Codes of antiskid::can::kPhaseNames.
constexpr std::uint8_t kSettling = 3;
constexpr std::uint8_t kBraking = 4;
constexpr std::uint8_t kStandstill = 5;

/// Longer at brake-on, where the speed is nearly constant and has the greatest effect.
constexpr double kWindow_s = 0.01;
constexpr double kBrakeOnWindow_s = 0.03;
/// After a gap, until readings are in order again and the windows of both speeds lie after it.
constexpr double kSettled_s = 0.06;
/// A released wheel on the rim is faster, of its speed, than this.
constexpr double kOnRim = 0.9;
/// After an abort the brake releases; the energy that it takes meanwhile counts, too. The measurement lasts at least until the windows of all speeds
/// are after the abort.
constexpr double kMinRelease_s = 0.06, kMaxRelease_s = 0.5;
/// At standstill a sensor that reports speed reads zero or its least count.
constexpr double kStands = 0.02;
/// Half the distance, as a ratio, to the nearest mistake of unit: bar for MPa is a factor of ten. A brake at its wear limit has half of its first
/// friction.
constexpr double kImplausibleFriction = 3.16;
/// Torque passes the PLC and is later than pressure: just after brake-on their ratio means nothing.
constexpr double kJudgedFriction_s = 0.2;
constexpr double kTurn_rad = 2.0 * std::numbers::pi;

EdgeLimits limits(double teeth, double max_radps, double late_s) {
    return {.edges_per_s = max_radps / kTurn_rad * teeth, .late_s = late_s};
}

ShaftSample as_on_bus(const antiskid::can::SpeedSignals& signals, const ShaftSample& sample) {
    const antiskid::can::RawSpeed raw =
        to_raw(signals, {.edge_count = sample.edge_count, .edge_time = sample.edge_time, .speed_radps = static_cast<float>(sample.speed_radps)});
    if (signals.source == antiskid::control::SpeedSource::speed) {
        return {.edges = false,
                .edge_count = 0,
                .edge_time = {},
                .speed_radps = static_cast<double>(static_cast<float>(signals.speed_radps.value(raw.speed)))};
    }
    const auto ticks = static_cast<std::int64_t>(static_cast<double>(sample.edge_time.count()) / signals.edge_time.scale);
    return {.edges = true,
            .edge_count = sample.edge_count,
            .edge_time = Time{static_cast<std::int64_t>(static_cast<double>(ticks) * signals.edge_time.scale)},
            .speed_radps = 0.0,
            .roll_over = sample.roll_over};
}

}  // namespace

MeterSample as_on_bus(const antiskid::can::Layout& layout, const MeterSample& sample) {
    const auto rounded = [](const antiskid::can::Signal& signal, double value) {
        return static_cast<double>(static_cast<float>(signal.rounded(static_cast<double>(static_cast<float>(value)))));
    };
    MeterSample out = sample;
    out.wheel = as_on_bus(layout.wheel, sample.wheel);
    out.flywheel = as_on_bus(layout.flywheel, sample.flywheel);
    out.pressure_Pa = rounded(layout.pressure_Pa, sample.pressure_Pa);
    out.vertical_N = rounded(layout.load_cells.vertical_N, sample.vertical_N);
    out.longitudinal_N = rounded(layout.load_cells.longitudinal_N, sample.longitudinal_N);
    out.brake_torque_Nm = rounded(layout.load_cells.brake_torque_Nm, sample.brake_torque_Nm);
    out.load_cells_age_s = layout.load_cells.age_ns.rounded(sample.load_cells_age_s * 1e9) * 1e-9;
    out.brake_temperature_C = rounded(layout.maneuver_state.brake_temperature_C, sample.brake_temperature_C);
    return out;
}

void Meter::Shaft::update(const ShaftSample& sample, double now_s, double scale) {
    edges_ = sample.edges;
    if (edges_) {
        if (sample.reported) track_.update(sample.edge_count, sample.edge_time, now_s, sample.roll_over);
        way_ = track_.way(now_s);
        speed_ = track_.speed(kWindow_s);
        return;
    }
    if (sample.reported) heard_s_ = now_s;
    const double speed = sample.speed_radps * scale;
    if (started_) way_ += 0.5 * (speed + speed_) * (now_s - last_s_);
    if (speed > kStands) {
        ++moving_updates_;
        moving_s_ = now_s;
    }
    started_ = true;
    speed_ = speed;
    last_s_ = now_s;
}

double Meter::Shaft::rest_s() const {
    return edges_ ? track_.last_edge_s() + track_.rest().time_s : moving_s_;
}

double Meter::Shaft::rest_way() const {
    return edges_ ? track_.way_at_edge() + track_.rest().way : way_;
}

std::string in_no_record(double max_J) {
    return fmt::format("and the brake may have taken up to {:.3g} MJ that are in no record", max_J * 1e-6);
}

Meter::Meter(const MeterParameters& parameters)
    : parameters_(parameters),
      wheel_(kTurn_rad / parameters.wheel_teeth, limits(parameters.wheel_teeth, parameters.wheel_max_radps, parameters.sensor_late_s)),
      flywheel_(kTurn_rad / parameters.flywheel_teeth * parameters.flywheel_radius_m,
                limits(parameters.flywheel_teeth, parameters.flywheel_max_radps, parameters.sensor_late_s)) {
    tail_.reserve(kTail);
}

double Meter::slip() const {
    if (!(flywheel_speed_ > 0.0)) return 0.0;
    const double radius = parameters_.wheel_radius_m - last_.vertical_N / parameters_.wheel_stiffness_Npm;
    return 1.0 - radius * wheel_.speed() / flywheel_speed_;
}

void Meter::feed(const MeterSample& sample) {
    if (sample.phase == kSettling && (!fed_ || last_.phase != kSettling)) {
        wheel_.measure_clock_again();
        flywheel_.measure_clock_again();
    }
    const bool begins = (sample.phase == kBraking || sample.braked) && (!fed_ || last_.phase != kBraking);
    // Brake-on happened while no frames came: the speeds before the gap are used.
    const bool unseen = begins && fed_ && (sample.phase != kBraking || sample.time_s - last_.time_s > kBrakeOnWindow_s);
    if (unseen) start(last_);
    wheel_.update(sample.wheel, sample.time_s, 1.0);
    flywheel_.update(sample.flywheel, sample.time_s, parameters_.flywheel_radius_m);
    flywheel_speed_ = flywheel_.speed();
    if (!hears(flywheel_, sample.time_s) || sample.time_s - last_.time_s > kBrakeOnWindow_s) flywheel_since_s_ = sample.time_s;
    const bool at_brake = sample.phase == kBraking || sample.phase == kStandstill;
    if (begins && !unseen) {
        start(sample);
    } else if (state_ == State::braking) {
        if (at_brake || !standstill_) integrate(sample);
        if (sample.phase == kStandstill) standstill_ = true;
        if (!at_brake) {
            final_ = now();
            ended_s_ = sample.time_s;
            state_ = standstill_ && hears(flywheel_, sample.time_s) ? State::over : State::releasing;
        }
    } else if (state_ == State::releasing) {
        integrate(sample);
        if (released(sample)) {
            final_ = figures();
            state_ = State::over;
        }
    }
    if (state_ != State::waiting) peak_temperature_C_ = std::max(peak_temperature_C_, sample.brake_temperature_C);
    last_ = sample;
    last_wheel_way_ = wheel_.way();
    last_flywheel_way_ = flywheel_.way();
    last_wheel_radps_ = wheel_.speed();
    last_flywheel_mps_ = flywheel_speed_;
    fed_ = true;
}

bool Meter::released(const MeterSample& sample) const {
    const double since_s = sample.time_s - std::max(ended_s_, flywheel_since_s_);
    return since_s > kMaxRelease_s || (since_s > kMinRelease_s && sample.pressure_Pa < kReleased_Pa);
}

void Meter::start(const MeterSample& sample) {
    state_ = State::braking;
    dropped_out_ = standstill_ = false;
    start_s_ = sample.time_s;
    start_way_m_ = flywheel_.way();
    start_mps_ = flywheel_.edges() ? flywheel_.track().speed(kBrakeOnWindow_s) : flywheel_.speed();
    start_radps_ = wheel_.edges() ? wheel_.track().speed(kBrakeOnWindow_s) : wheel_.speed();
    sums_ = {.time_s = sample.time_s, .torque_Nms = 0.0, .load_Ns = 0.0, .pressure_Pas = 0.0};
    work_balance_ = WorkBalance(sample.time_s);
    knot_ = knot_at(sample);
    steps_ahead_ = 0;
    age_s_ = 0.0;
    wheel_reported_ = flywheel_reported_ = false;
    span_ = span_at(sample.time_s);
    unknown_J_ = 0.0;
    hole_ = false;
    sliding_pressure_Pas_ = sliding_way_m_ = 0.0;
    peak_temperature_C_ = sample.brake_temperature_C;
    tail_.assign(1, sums_);
    motion_updates_ = flywheel_.motion_updates();
}

Work Meter::by_cells(const Knot& from, const MeterSample& to, const Way& way) const {
    const double torque = 0.5 * (to.brake_torque_Nm + from.torque_Nm);
    const double load = 0.5 * (to.vertical_N + from.vertical_N);
    const double force = 0.5 * (to.longitudinal_N + from.longitudinal_N);
    const double radius = parameters_.wheel_radius_m - load / parameters_.wheel_stiffness_Npm;
    return {.brake_J = torque * way.angle,
            .tyre_J = force * (way.metres - radius * way.angle),
            .torque_Nms = torque * way.time_s,
            .sliding_torque_Nms = torque * way.sliding_s,
            .friction_way_m = load > 0.0 ? force / load * way.sliding_m : 0.0};
}

Work Meter::catch_up(double time_s) {
    Work by_speeds;
    for (; steps_ahead_ > 0 && steps_[first_step_].time_s <= time_s; --steps_ahead_) {
        knot_.way.add(steps_[first_step_].way);
        by_speeds += steps_[first_step_].by_speeds;
        first_step_ = (first_step_ + 1) % kAhead;
    }
    return by_speeds;
}

WorkAhead Meter::ahead(const MeterSample& sample) const {
    Way way;
    WorkAhead ahead;
    for (std::size_t i = 0; i < steps_ahead_; ++i) {
        const Step& step = steps_[(first_step_ + i) % kAhead];
        way.add(step.way);
        ahead.by_speeds += step.by_speeds;
    }
    ahead.by_cells = by_cells(knot_at(sample), sample, way);
    return ahead;
}

/// Integrates the equations of motion of flywheel and wheel, with the last known load. After a gap the slip of the distances counted in it holds
/// for all of it; it ends when the windows of both speeds lie after it. Until both shafts are heard again the wheel keeps its last slip.
Work Meter::by_speeds(const MeterSample& sample, bool both_reported) {
    const double v = flywheel_speed_, omega = wheel_.speed();
    const double load = 0.5 * (sample.vertical_N + last_.vertical_N);
    const double radius = parameters_.wheel_radius_m - load / parameters_.wheel_stiffness_Npm;
    Span& span = span_;
    span.metres += flywheel_.way() - last_flywheel_way_;
    span.angle += wheel_.way() - last_wheel_way_;
    const double mean_mps = 0.5 * (span.flywheel_mps + v), mean_radps = 0.5 * (span.wheel_radps + omega);
    if (sample.time_s - span.reported_s > kBrakeOnWindow_s) {
        span.gap = true;
        span.back_s = sample.time_s;
    }
    if (both_reported) {
        if (!span.gap)
            rolling_ = mean_mps > 0.0 ? radius * mean_radps / mean_mps : 1.0;
        else if (span.metres > 0.0)  // a held wheel may have less way than was expected of it before
            rolling_ = radius * std::max(span.angle, 0.0) / span.metres;
        span.reported_s = sample.time_s;
    }
    const double rim_Ns = parameters_.flywheel_mass_kg * (span.flywheel_mps - v);
    const double wheel_Nms = parameters_.wheel_inertia_kgm2 * (span.wheel_radps - omega);
    const double rim_J = rim_Ns * mean_mps;
    const double torque_Nms = radius * rim_Ns + wheel_Nms;
    // After an abort the wheel leaves the rim: what it turned in the gap is not all of its slip.
    const bool aborted = sample.phase != kBraking && sample.phase != kStandstill;
    span.unknown_J = span.gap && aborted && radius * omega < kOnRim * v ? std::max((1.0 - rolling_) * rim_J, 0.0) : 0.0;
    Work step{.brake_J = rolling_ * rim_J + wheel_Nms * mean_radps - span.given.brake_J,
              .tyre_J = (1.0 - rolling_) * rim_J - span.given.tyre_J,
              .torque_Nms = torque_Nms - span.given.torque_Nms};
    if (sliding()) step.sliding_torque_Nms = step.torque_Nms;
    if (!dropped_out_ && load > 0.0)
        step.friction_way_m = parameters_.flywheel_mass_kg * 0.5 * (last_flywheel_mps_ * last_flywheel_mps_ - v * v) / load;
    if (both_reported && (!span.gap || sample.time_s - span.back_s > kSettled_s)) {
        unknown_J_ += span.unknown_J;
        span_ = span_at(sample.time_s);
    } else {
        span.given += step;
    }
    return step;
}

void Meter::integrate(const MeterSample& sample) {
    const double h = sample.time_s - last_.time_s;
    const double pressure = 0.5 * (sample.pressure_Pa + last_.pressure_Pa);
    const bool repeated =
        sample.brake_torque_Nm == last_.brake_torque_Nm && sample.vertical_N == last_.vertical_N && sample.longitudinal_N == last_.longitudinal_N;
    const bool moves = hears(wheel_, sample.time_s) && hears(flywheel_, sample.time_s);  // without motion, torque has no angle
    const CellReading reading = !sample.load_cells_reported || !moves ? CellReading::none : repeated ? CellReading::repeated : CellReading::fresh;
    const bool silent = work_balance_.silent();
    hole_ = h > kBrakeOnWindow_s || (hole_ && silent);
    const double metres = flywheel_.way() - last_flywheel_way_;
    const Way way{.time_s = h,
                  .sliding_s = sliding() ? h : 0.0,
                  .angle = wheel_.way() - last_wheel_way_,
                  .metres = metres,
                  .sliding_m = dropped_out_ ? 0.0 : metres};
    if (reading != CellReading::none) age_s_ = std::clamp(sample.load_cells_age_s, 0.0, kMaxAge_s);
    // Half a period: a step is moved if most of it is as old as the reading.
    const double read_s = sample.time_s - age_s_ + 0.5 * parameters_.period_s;
    Work stepped = catch_up(steps_ahead_ == kAhead ? steps_[first_step_].time_s : read_s);
    wheel_reported_ = wheel_reported_ || sample.wheel.reported;
    flywheel_reported_ = flywheel_reported_ || sample.flywheel.reported;
    const bool both_reported = moves && wheel_reported_ && flywheel_reported_;
    if (both_reported) wheel_reported_ = flywheel_reported_ = false;
    steps_[(first_step_ + steps_ahead_++) % kAhead] = {.time_s = sample.time_s, .way = way, .by_speeds = by_speeds(sample, both_reported)};
    stepped += catch_up(read_s);
    if (work_balance_.add(sample.time_s, reading, by_cells(knot_, sample, knot_.way), stepped, ahead(sample))) knot_ = knot_at(sample);
    sums_.time_s = sample.time_s;
    sums_.torque_Nms = work_balance_.work().torque_Nms;
    sums_.load_Ns += 0.5 * (sample.vertical_N + last_.vertical_N) * h;
    sums_.pressure_Pas += pressure * h;
    if (!dropped_out_) {
        if (sliding()) sliding_pressure_Pas_ += std::max(pressure - parameters_.contact_pressure_Pa, 0.0) * h;
        sliding_way_m_ += metres;
        dropped_out_ = flywheel_speed_ <= parameters_.drop_out_mps;
    }
    if (work_balance_.silent() && !silent) tail_.clear();  // its entries have the other source of torque
    if (flywheel_.motion_updates() != motion_updates_) {
        motion_updates_ = flywheel_.motion_updates();
        tail_.clear();
    }
    if (tail_.size() < kTail) tail_.push_back(sums_);
}

Meter::Sums Meter::sums_at(double time_s) const {
    if (time_s <= tail_.front().time_s) return tail_.front();
    if (time_s >= tail_.back().time_s) return tail_.back();
    const auto after = std::upper_bound(tail_.begin(), tail_.end(), time_s, [](double t, const Sums& sums) { return t < sums.time_s; });
    const Sums& b = *after;
    const Sums& a = *(after - 1);
    const double w = (time_s - a.time_s) / (b.time_s - a.time_s);
    return {.time_s = time_s,
            .torque_Nms = a.torque_Nms + w * (b.torque_Nms - a.torque_Nms),
            .load_Ns = a.load_Ns + w * (b.load_Ns - a.load_Ns),
            .pressure_Pas = a.pressure_Pas + w * (b.pressure_Pas - a.pressure_Pas)};
}

Figures Meter::figures() const {
    if (state_ == State::waiting) return {};
    const bool ended = state_ == State::releasing || state_ == State::over;
    Figures figures = ended ? final_ : now();
    if (state_ == State::releasing) {
        const Figures released = now();
        figures.energy_brake_J = released.energy_brake_J;
        figures.energy_tyre_J = released.energy_tyre_J;
        figures.kinetic_energy_J = released.kinetic_energy_J;
    }
    figures.peak_temperature_C = peak_temperature_C_;
    return figures;
}

double Meter::kinetic_lost_J(double v_mps, double omega_radps) const {
    return 0.5 * parameters_.flywheel_mass_kg * (start_mps_ * start_mps_ - v_mps * v_mps) +
           0.5 * parameters_.wheel_inertia_kgm2 * (start_radps_ * start_radps_ - omega_radps * omega_radps);
}

double Meter::kinetic_energy_J() const {
    const double omega = wheel_.speed();
    return 0.5 * parameters_.flywheel_mass_kg * flywheel_speed_ * flywheel_speed_ + 0.5 * parameters_.wheel_inertia_kgm2 * omega * omega;
}

std::vector<std::string> Meter::warnings() const {
    std::vector<std::string> all;
    for (const auto& [shaft, what] : {std::pair{&wheel_, "wheel"}, std::pair{&flywheel_, "flywheel"}})
        if (const std::uint64_t n = shaft->track().restarts(); n != 0) all.push_back(fmt::format("encoder_restarted: {} {}", what, n));
    if (state_ == State::waiting) return all;
    const Figures f = figures();
    if (const double silent_s = work_balance_.silent_s(); silent_s > 0.0) {
        all.push_back(fmt::format("{}: {:.4g} MJ of the brake's {:.4g} MJ, load cells or encoders silent for {:.3g} s", kEnergyBySpeeds,
                                  work_balance_.by_speeds().brake_J * 1e-6, f.energy_brake_J * 1e-6, silent_s));
        if (const double unknown_J = unknown_J_ + span_.unknown_J; unknown_J > 0.0) all.back() += ", " + in_no_record(unknown_J);
    }
    const double used_J = f.energy_brake_J + f.energy_tyre_J;
    const double band_J = parameters_.energy_band * kinetic_lost_J(0.0, 0.0);
    // A rig that does not measure F_x does not know the tyre's energy.
    const bool too_little = f.energy_tyre_J != work_balance_.by_speeds().tyre_J && used_J < f.kinetic_energy_J - band_J;
    if (too_little || used_J > f.kinetic_energy_J + band_J)
        all.push_back(fmt::format("{}: brake and tyre took {:.4g} MJ of {:.4g} MJ kinetic energy", kEnergyUnbalanced, used_J * 1e-6,
                                  f.kinetic_energy_J * 1e-6));
    const double ratio = f.mean_friction / parameters_.friction;
    if (parameters_.friction > 0.0 && f.mean_friction > 0.0 && f.duration_s > kJudgedFriction_s &&
        (ratio > kImplausibleFriction || ratio < 1.0 / kImplausibleFriction))
        all.push_back(fmt::format("{}: mean mu_b {:.4g} by torque over pressure, {:.4g} is the brake's", kFrictionImplausible, f.mean_friction,
                                  parameters_.friction));
    return all;
}

Figures Meter::now() const {
    Figures f;
    const double end_s = standstill_ ? flywheel_.rest_s() : sums_.time_s;
    const double end_way_m = standstill_ ? flywheel_.rest_way() : flywheel_.way();
    const Sums sums = standstill_ ? sums_at(end_s) : sums_;
    const Work work = work_balance_.work();
    f.brake_on_mps = start_mps_;
    f.duration_s = end_s - start_s_;
    f.length_m = end_way_m - start_way_m_;
    if (const double covered_s = sums.time_s - start_s_; covered_s > 0.0) {
        f.mean_torque_Nm = sums.torque_Nms / covered_s;
        f.mean_load_N = sums.load_Ns / covered_s;
        f.mean_pressure_Pa = sums.pressure_Pas / covered_s;
    }
    if (sliding_pressure_Pas_ > 0.0) f.mean_friction = work.sliding_torque_Nms / sliding_pressure_Pas_ / parameters_.brake_gain_m3;
    f.energy_brake_J = work.brake_J;
    f.energy_tyre_J = work.tyre_J;
    const double v = standstill_ ? 0.0 : flywheel_speed_;
    const double omega = standstill_ ? 0.0 : wheel_.speed();
    f.kinetic_energy_J = kinetic_lost_J(v, omega);
    if (sliding_way_m_ > 0.0 && parameters_.peak_friction > 0.0) f.j_mu = work.friction_way_m / (sliding_way_m_ * parameters_.peak_friction);
    f.standstill = standstill_;
    return f;
}

}  // namespace rig::record
