#include "plant_sim/study/robust/soonest.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "firmware/control/slip_law.hpp"
#include "plant_sim/study/robust/held_reference.hpp"

namespace robust {

namespace {

constexpr double kFullCurrent_mA = 1e3;  // beyond the end of the map

/// A rigid wheel behind the valve, no sensors.
class BrakedWheel {
  public:
    BrakedWheel(const rig::RigParameters& rig, double v_mps, double slip, double step_s)
        : rig_(&rig),
          brake_(rig.brake, rig.friction_curve, rig.mean_friction, rig.brake_on_mps),
          wheel_(rig.wheel, brake_, rig.surface),
          valve_(rig.valve, step_s) {
        state_.v_mps = v_mps;
        state_.omega_radps = (1.0 - slip) * v_mps / forces().radius_m;
        state_.held = false;
        const double pressure_Pa = balance_Pa();
        constexpr int kSettled = 1000;  // steps
        for (int i = 0; i < kSettled; ++i) valve_.advance(pressure_Pa, pressure_Pa);
    }

    void meet(const rig::Surface& surface) { wheel_.set_tyre(surface.law()); }

    void step(double current_mA) {
        const double static_Pa = rig_->pressure_map.pressure_Pa(current_mA);
        const plant::Valve::Arcs arcs = valve_.advance(static_Pa, static_Pa);
        if (valve_.first_s() > 0.0) wheel_.advance(state_, arcs.first, load(), valve_.first_s());
        wheel_.advance(state_, arcs.second, load(), valve_.second_s());
    }

    /// The pressure that keeps this slip while the aircraft slows down.
    [[nodiscard]] double balance_Pa() const { return balance_Pa(forces().slip, forces().mu); }
    [[nodiscard]] double balance_Pa(double slip, double mu) const {
        const plant::Forces now = forces();
        const double slows_radps2 = (1.0 - slip) / now.radius_m * mu * now.F_z_N / rig_->wheel.mass_kg;
        return (mu * now.F_z_N * now.radius_m + rig_->wheel.inertia_kgm2 * slows_radps2) / brake_.gain(state_.v_mps).k_b;
    }
    [[nodiscard]] double pressure_Pa() const { return valve_.pressure_Pa(); }
    [[nodiscard]] const plant::WheelState& state() const { return state_; }
    [[nodiscard]] plant::Forces forces() const { return wheel_.forces(state_, valve_.pressure_Pa(), load()); }

  private:
    [[nodiscard]] plant::LoadArc load() const { return {rig_->load.base_N, 0.0, rig_->load.lift_Ns2pm2}; }

    const rig::RigParameters* rig_;
    plant::BrakeTorque brake_;
    plant::Wheel wheel_;
    plant::Valve valve_;
    plant::WheelState state_;
};

/// Cuts the current off until the slip stops rising, which may be after the valve's delay. True as soon as `too_much` holds for the wheel.
template <typename TooMuch>
bool exceeds_when_released(BrakedWheel& wheel, const TooMuch& too_much, double delay_s, double period_s) {
    double slip = 0.0;
    for (int i = 0; i * period_s < delay_s + 2.0 * period_s || wheel.forces().slip > slip; ++i) {
        slip = wheel.forces().slip;
        wheel.step(0.0);
        if (too_much(wheel)) return true;
    }
    return false;
}

double reference_at(const antiskid::control::SlipConfig& config, double slip_reference, double v_mps) {
    return static_cast<double>(antiskid::control::falling_reference(config, static_cast<float>(slip_reference), static_cast<float>(v_mps)));
}

/// Of the stop so far, and held exactly from here to drop-out.
double stop_j_mu(const BrakedWheel& wheel, const rig::RigParameters& rig, const antiskid::control::SlipConfig& config, double slip_reference,
                 double drop_out_mps) {
    const FrictionDistance rest = held_distance(rig, config, slip_reference, wheel.state().v_mps, drop_out_mps);
    return (wheel.state().friction_distance_m + rest.had_m) / (rig::peak(rig.surface).mu * wheel.state().distance_m + rest.max_m);
}

}  // namespace

double soonest_j_mu(const rig::RigParameters& rig, const antiskid::control::SlipConfig& config, double slip_reference, double drop_out_mps,
                    double period_s) {
    BrakedWheel wheel(rig, rig.brake_on_mps, 0.0, period_s);
    const auto has_more = [&](const BrakedWheel& w) { return w.forces().slip > reference_at(config, slip_reference, w.state().v_mps); };
    const auto release = [&](BrakedWheel& w) { return exceeds_when_released(w, has_more, rig.valve.delay_s, period_s); };
    while (wheel.state().v_mps > drop_out_mps) {
        BrakedWheel next = wheel;
        next.step(kFullCurrent_mA);
        BrakedWheel released = next;
        if (release(released)) break;
        wheel = std::move(next);
    }
    (void)release(wheel);
    return stop_j_mu(wheel, rig, config, slip_reference, drop_out_mps);
}

double wary_j_mu(const rig::RigParameters& rig, const antiskid::control::SlipConfig& config, double slip_reference, double drop_out_mps,
                 double period_s, double late_s) {
    const auto locks = [](const BrakedWheel& w) { return w.forces().slip > 0.9; };
    constexpr double kSteep = 1e4;  // a runway whose friction rises at hardly any slip
    BrakedWheel wheel(rig, rig.brake_on_mps, 0.0, period_s);
    const double earliest_slip = static_cast<double>(config.earliest_peak_slip);
    std::vector<plant::Forces> felt;  // one per period
    const auto late = static_cast<std::size_t>(std::lround(late_s / period_s));
    while (wheel.state().v_mps > drop_out_mps) {
        const plant::Forces now = wheel.forces();
        if (now.slip >= reference_at(config, slip_reference, wheel.state().v_mps)) break;
        felt.push_back(now);
        const plant::Forces& known = felt[felt.size() > late ? felt.size() - 1 - late : 0];
        // First along the chord, to its value at the earliest peak.
        const double rises = known.slip > 0.0 && known.slip < earliest_slip ? earliest_slip / known.slip : 1.0;
        BrakedWheel released = wheel;
        released.step(kFullCurrent_mA);
        released.meet({.name = {}, .c1 = known.mu * rises, .c2 = rises > 1.0 ? 1.0 / earliest_slip : kSteep, .c3 = 0.0});
        const bool would_lock = exceeds_when_released(released, locks, rig.valve.delay_s, period_s);
        wheel.step(would_lock ? 0.0 : kFullCurrent_mA);
    }
    return stop_j_mu(wheel, rig, config, slip_reference, drop_out_mps);
}

SoonestRegrip soonest_regrip(const rig::RigParameters& rig, const rig::Surface& other, double speed_mps, double period_s) {
    const rig::Peak target = rig::peak(other);
    BrakedWheel wheel(rig, speed_mps, rig::peak(rig.surface).slip, period_s);
    wheel.meet(other);
    const auto too_much = [&] { return wheel.forces().slip > target.slip || wheel.pressure_Pa() > wheel.balance_Pa(target.slip, target.mu); };
    const bool releases = too_much();
    RegripMeter meter(period_s);
    meter.update(rig.surface, speed_mps, rig::peak(rig.surface).mu);
    bool there = false;
    double v_mps = speed_mps, had_m = 0.0, max_m = 0.0;
    const auto periods = std::lround(RegripMeter::kLongest_s / period_s);
    for (long i = 0; i < periods && v_mps >= RegripMeter::kEnds_mps; ++i) {
        double mu = target.mu;
        if (there) {
            v_mps -= mu * (rig.load.base_N - rig.load.lift_Ns2pm2 * v_mps * v_mps) / rig.wheel.mass_kg * period_s;
        } else {
            wheel.step(releases ? 0.0 : kFullCurrent_mA);
            v_mps = wheel.state().v_mps;
            mu = wheel.forces().mu;
            there = releases ? !too_much() : wheel.forces().slip >= target.slip;
        }
        meter.update(other, v_mps, mu);
        had_m += mu * v_mps;
        max_m += target.mu * v_mps;
    }
    return {.regrip = meter.regrip().value_or(Regrip{}), .j_mu = had_m / max_m};
}

}  // namespace robust
