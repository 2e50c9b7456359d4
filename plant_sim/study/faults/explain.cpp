#include "plant_sim/study/faults/explain.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/control/estimator.hpp"
#include "firmware/control/slip_law.hpp"
#include "firmware/control/valve_model.hpp"

namespace faults {

using antiskid::control::Command;
using antiskid::control::Estimate;
using antiskid::control::Sensors;
using antiskid::control::SpeedReading;
using antiskid::control::State;

namespace {

/// Computes the symptoms during a stop, with an estimator of its own.
class SymptomMeter {
  public:
    explicit SymptomMeter(const antiskid::control::Config& config) : config_(config), estimator_(config) {}

    /// Call after each step of the controller with its inputs and its command. `counts`: whether the fault has begun.
    void take(const Sensors& sensors, const Command& command, bool counts);
    [[nodiscard]] Symptoms symptoms() const;

  private:
    void take_wheel(const Estimate& before);
    void take_pressure(const Sensors& sensors, double model_before_Pa);

    antiskid::control::Config config_;
    antiskid::control::Estimator estimator_;
    float held_Pa_ = 0.0F;
    bool begun_ = false;
    std::uint32_t refused_before_ = 0;
    std::uint32_t refused_ = 0;
    double late_s_ = 0.0;
    double readings_ = 0.0, wild_ = 0.0, most_wild_ = 0.0, squares_ = 0.0;
    double impulse_Ns_ = 0.0, began_mps_ = 0.0, now_mps_ = 0.0;
    double periods_ = 0.0, off_Pa_ = 0.0, lag_up_ = 0.0, lag_down_ = 0.0;
    double excess_s_ = 0.0, most_excess_s_ = 0.0;
};

void SymptomMeter::take_wheel(const Estimate& before) {
    const SpeedReading& reading = estimator_.wheel_reading();
    if (!reading.fresh) return;
    const double period_s = static_cast<double>(config_.period_s);
    const double took_s = static_cast<double>(reading.interval_s);
    const double since_s = std::max(took_s, period_s);
    const double age_s = 0.5 * (took_s + std::min(took_s, period_s));
    const double expected = static_cast<double>(before.omega_radps) + static_cast<double>(before.omega_dot_radps2) * (period_s - age_s);
    const double off = static_cast<double>(reading.speed_radps) - expected;
    const double pitch_rad = 2.0 * std::numbers::pi / static_cast<double>(config_.wheel.encoder.teeth);
    const double noise = static_cast<double>(config_.observer.reading_noise) * pitch_rad / since_s;
    const double brakes_radps2 = static_cast<double>(before.brake_gain) * static_cast<double>(estimator_.estimate().pressure.pressure_Pa);
    const double acts_radps2 =
        off < 0.0 ? static_cast<double>(config_.wheel.hardest_brake) * std::max(brakes_radps2, static_cast<double>(before.road_radps2))
                  : static_cast<double>(config_.wheel.encoder.max_acceleration_radps2);
    constexpr double kChance = 4.0;  // standard deviations
    const bool fast = before.v_mps > 3.0F * config_.monitor.plausible_above_mps;
    constexpr double kForgotten_per_s = 2.0;
    wild_ = std::max(wild_ - kForgotten_per_s * since_s, 0.0);
    wild_ += fast && std::abs(off) > acts_radps2 * since_s + kChance * noise ? 1.0 : 0.0;
    most_wild_ = std::max(most_wild_, wild_);
    readings_ += 1.0;
    squares_ += off * off / (noise * noise);
}

void SymptomMeter::take_pressure(const Sensors& sensors, double model_before_Pa) {
    const double model_Pa = static_cast<double>(estimator_.uncorrected_pressure_Pa());
    const double reads_Pa = static_cast<double>(sensors.pressure.pressure_Pa);
    const double rate = (model_Pa - model_before_Pa) / static_cast<double>(config_.period_s);
    periods_ += 1.0;
    off_Pa_ += std::abs(reads_Pa - model_Pa);
    lag_up_ += (model_Pa - reads_Pa) * rate;
    lag_down_ += rate * rate;
}

void SymptomMeter::take(const Sensors& sensors, const Command& command, bool counts) {
    const Estimate before = estimator_.estimate();
    const double model_before_Pa = static_cast<double>(estimator_.uncorrected_pressure_Pa());
    const Estimate& e = estimator_.update(sensors, held_Pa_);
    held_Pa_ = antiskid::control::valve_pressure_Pa(config_.valve, command.current_mA);
    const std::uint32_t refused = sensors.wheel.rejected + sensors.flywheel.rejected + sensors.pressure.rejected + sensors.maneuver.rejected;
    if (counts) {
        refused_ += refused - refused_before_;
        late_s_ = std::max(late_s_, static_cast<double>(estimator_.wheel_reading().late_s));
    }
    refused_before_ = refused;
    if (!counts || (command.state != State::braking && command.state != State::locked_wheel)) return;
    const double period_s = static_cast<double>(config_.period_s);
    now_mps_ = static_cast<double>(e.v_mps);
    if (!begun_) began_mps_ = now_mps_;
    begun_ = true;
    impulse_Ns_ += static_cast<double>(config_.wheel.inertia_kgm2 * e.road_radps2 / e.radius_m) * period_s;
    take_wheel(before);
    take_pressure(sensors, model_before_Pa);
    const double excess = static_cast<double>(e.slip - command.slip_reference - antiskid::control::kHeldWithin);
    excess_s_ = std::max(excess_s_ + excess * period_s, 0.0);
    most_excess_s_ = std::max(most_excess_s_, excess_s_);
}

Symptoms SymptomMeter::symptoms() const {
    const auto share = [](double part, double whole) { return whole > 0.0 ? part / whole : 0.0; };
    return {late_s_,
            static_cast<double>(refused_),
            most_wild_,
            std::sqrt(share(squares_, readings_)),
            share(impulse_Ns_, began_mps_ - now_mps_),
            share(off_Pa_, periods_),
            share(lag_up_, lag_down_),
            most_excess_s_};
}

struct Measured {
    Result result;
    Symptoms symptoms{};
    double began_m = 0.0;  ///< position on the runway at which the fault began
};

Measured measure(const FaultPlan& plan, const Case& c, const FaultFree& fault_free) {
    Measured measured;
    SymptomMeter meter(plan.controller);
    bool begun = false;
    measured.result = run_one(plan, c, fault_free, [&](const Period& p) {
        if (p.begun && !begun) measured.began_m = p.session.rig().runway_m();
        begun = p.begun;
        if (p.given != nullptr) meter.take(*p.given, p.command, p.begun);
    });
    measured.symptoms = meter.symptoms();
    return measured;
}

/// The same stop on `rig` without a fault, with the runway's friction multiplied by `grip` from `from_m` on.
FaultPlan on_runway(const FaultPlan& plan, const Case& c, rig::RigParameters rig, double grip, double from_m) {
    FaultPlan other = plan;
    rig::Surface less = rig.surface;
    less.c1 *= grip;
    less.c3 *= grip;
    if (less.magic) less.magic->D *= grip;
    rig.runway = {.patches = {{from_m, less}}};
    other.surfaces[c.surface].rig = rig;
    return other;
}

Case without_fault(Case c) {
    c.fault.lasts_s = 0.0;
    return c;
}

void widen(std::array<Span, kSymptomNames.size()>& spans, const Symptoms& symptoms, bool first) {
    for (std::size_t i = 0; i < symptoms.size(); ++i) {
        spans[i].least = first ? symptoms[i] : std::min(spans[i].least, symptoms[i]);
        spans[i].most = first ? symptoms[i] : std::max(spans[i].most, symptoms[i]);
    }
}

}  // namespace

Explanation explain(const FaultPlan& plan, const Case& c, const robust::Basis& basis, const ExplainOptions& options) {
    const FaultFree fault_free = run_fault_free(plan, c);
    const Measured faulty = measure(plan, c, fault_free);
    Explanation e{.run = c, .result = faulty.result, .symptoms = faulty.symptoms};
    const rig::RigParameters& rig = plan.surfaces[c.surface].rig;
    const double wanted = faulty.result.verdict.distance_share;
    const Case twin = without_fault(c);
    // Less friction gives a longer stop: bisection in the logarithm.
    constexpr int kHalvings = 9;
    constexpr double kLeast = 0.05;
    const auto share_at = [&](double grip) {
        return run_one(on_runway(plan, c, rig, grip, faulty.began_m), twin, fault_free).verdict.distance_share;
    };
    double low = kLeast, high = 1.0;
    if (wanted > 1.0) {
        for (int i = 0; i < kHalvings; ++i) {
            const double middle = std::sqrt(low * high);
            (share_at(middle) > wanted ? low : high) = middle;
        }
    }
    e.grip = high;
    e.twin_share = share_at(e.grip);
    for (std::size_t i = 0; i < options.twins; ++i) {
        Case other = twin;
        other.sensor_seed += i + 1;  // another seed than the run's: its own noise would not show the scatter
        widen(e.twins, measure(on_runway(plan, c, rig, e.grip, faulty.began_m), other, fault_free).symptoms, i == 0);
    }
    for (std::size_t i = 0; i < options.rigs; ++i) {
        rig::RigParameters drawn = robust::draw(basis, robust::Family::all, options.rig_seed, i).rig;
        drawn.surface = rig.surface;
        widen(e.drawn, measure(on_runway(plan, c, drawn, e.grip, faulty.began_m), twin, fault_free).symptoms, i == 0);
    }
    return e;
}

}  // namespace faults
