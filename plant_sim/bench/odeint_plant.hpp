/// The plant's equations, integrated by boost::odeint's Dormand-Prince method of order five with error control, as the obvious alternative.
#pragma once

#include <array>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <vector>

#include "plant_sim/model/rig.hpp"

namespace bench {

enum : std::size_t { kSpeed, kOmega, kPressure, kPressureRate, kDistance, kAngle, kBrake, kTyre, kFriction, kStates };
using OdeState = std::array<double, kStates>;

/// Right-hand side of eq. (1) to (6) and (9); the static pressure is linear in time.
class Equations {
  public:
    explicit Equations(const rig::RigParameters& rig);

    void operator()(const OdeState& x, OdeState& dx, double t) const {
        const double v = x[kSpeed] > plant::Wheel::kSlowest_mps ? x[kSpeed] : plant::Wheel::kSlowest_mps;
        const double omega = x[kOmega] > 0.0 ? x[kOmega] : 0.0;
        const double F_z = loaded ? base_N_ - lift_ * v * v : 0.0;
        const double r = free_radius_ - F_z * per_stiffness_;
        const double slip = 1.0 - omega * r / v;
        const double mu = friction(slip);
        const double F_x = F_z * mu;
        const double T_b = brake_.gain(v).k_b * (x[kPressure] > 0.0 ? x[kPressure] : 0.0);
        const double static_Pa = start_Pa + slope_Paps * (t - start_s);
        dx[kSpeed] = -F_x * per_mass_;
        dx[kOmega] = (r * F_x - T_b) * per_inertia_;
        if (x[kOmega] <= 0.0 && dx[kOmega] < 0.0) dx[kOmega] = 0.0;  // a locked wheel is held
        dx[kPressure] = x[kPressureRate];
        dx[kPressureRate] = w2_ * (static_Pa - x[kPressure]) - damping_ * x[kPressureRate];
        dx[kDistance] = v;
        dx[kAngle] = omega;
        dx[kBrake] = T_b * omega;
        dx[kTyre] = F_x * slip * v;
        dx[kFriction] = mu * v;
    }

    [[nodiscard]] double rolling_radps(double v) const { return v / (free_radius_ - (base_N_ - lift_ * v * v) * per_stiffness_); }

    bool loaded = true;
    double start_s = 0.0, start_Pa = 0.0, slope_Paps = 0.0;

  private:
    /// Eq. (4) with libm's exp, which is faster for a single evaluation than the plant's own, made for vectors.
    [[nodiscard]] double friction(double slip) const {
        const double magnitude = tyre_.c1 * (1.0 - std::exp(-tyre_.c2 * std::abs(slip))) - tyre_.c3 * std::abs(slip);
        return std::copysign(magnitude, slip);
    }

    plant::BrakeTorque brake_;
    rig::FrictionLaw tyre_;
    double base_N_, lift_, free_radius_, per_stiffness_, per_mass_, per_inertia_, w2_, damping_;
};

using Dopri5 = boost::numeric::odeint::runge_kutta_dopri5<OdeState>;

/// Replaces plant::Rig in a closed loop: valve, wheel and the same sensors, with steps of 1 ms.
class OdeintRig {
  public:
    OdeintRig(const rig::RigParameters& rig, double tolerance, std::uint64_t seed);

    void touch_down() { equations_.loaded = true; }
    void advance_current(double current_mA);

    [[nodiscard]] double time_s() const { return static_cast<double>(steps_) * kStep_s; }
    [[nodiscard]] bool standstill() const { return x_[kSpeed] <= plant::Wheel::kSlowest_mps; }
    [[nodiscard]] const plant::Encoder& wheel_encoder() const { return wheel_encoder_; }
    [[nodiscard]] const plant::Encoder& flywheel_encoder() const { return flywheel_encoder_; }
    [[nodiscard]] double measured_pressure_Pa() const { return measured_Pa_; }
    [[nodiscard]] double v_mps() const { return x_[kSpeed]; }
    [[nodiscard]] double distance_m() const { return x_[kDistance]; }
    [[nodiscard]] double friction_distance_m() const { return x_[kFriction]; }

  private:
    static constexpr double kStep_s = 1e-3;

    rig::RigParameters parameters_;
    Equations equations_;
    boost::numeric::odeint::result_of::make_controlled<Dopri5>::type stepper_;
    OdeState x_{};
    double next_step_s_ = kStep_s;
    std::vector<double> delay_line_;
    std::size_t next_ = 0;
    plant::Encoder wheel_encoder_, flywheel_encoder_;
    rig::Random random_;
    std::uint64_t steps_ = 0;
    double measured_Pa_ = 0.0;
};

}  // namespace bench
