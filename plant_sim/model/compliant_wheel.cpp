#include "plant_sim/model/compliant_wheel.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <unsupported/Eigen/AutoDiff>

namespace plant {

namespace {

constexpr double kSlowest_mps = Wheel::kSlowest_mps;

double value_of(double number) {
    return number;
}
/// mu and its slope with their derivatives by the slip.
void friction_at(const rig::TyreCurve& curve, double slip, double& mu, double& mu_1) {
    const rig::Friction f = rig::friction(curve, slip);
    mu = f.mu;
    mu_1 = f.mu_1;
}
/// Under a locked rim the belt oscillates at slips where eq. (4) is negative; friction() returns its magnitude, which increases again. With the other
/// sign here the method has at most order two and needs a hundred times as many steps.
double slope_of_magnitude(const rig::FrictionLaw& law, double slip, double mu_1) {
    return law.c3 * std::abs(slip) > law.c1 ? -mu_1 : mu_1;
}
double slope_of_magnitude(const rig::MagicFormula& /*law*/, double /*slip*/, double mu_1) {
    return mu_1;
}
template <typename Derivatives>
double value_of(const Eigen::AutoDiffScalar<Derivatives>& number) {
    return number.value();
}
template <typename Derivatives>
void friction_at(const rig::TyreCurve& curve, const Eigen::AutoDiffScalar<Derivatives>& slip, Eigen::AutoDiffScalar<Derivatives>& mu,
                 Eigen::AutoDiffScalar<Derivatives>& mu_1) {
    std::visit(
        [&](const auto& law) {
            const rig::Friction f = rig::friction(law, slip.value());
            mu = {f.mu, Derivatives(slope_of_magnitude(law, slip.value(), f.mu_1) * slip.derivatives())};
            mu_1 = {f.mu_1, Derivatives(f.mu_2 * slip.derivatives())};
        },
        curve);
}

enum : int { kSpeed, kAxle, kLeg, kRim, kTwist, kBelt, kSlip, kParts };
static_assert(kParts == CompliantWheel::kParts);
template <typename Number>
using Vector = Eigen::Matrix<Number, kParts, 1>;
using Motion = Vector<double>;
using Matrix = Eigen::Matrix<double, kParts, kParts>;

/// Increments of the sums in WheelState and of the leg's energy.
struct Sums {
    double distance_m, angle_rad, brake_J, tyre_J, friction_m, leg_J;
};

template <typename Number>
struct Contact {
    Number F_z, r, slip, mu, F_x;
    Number mu_1;  // of the curve over slip, before a wet runway scales it
};

/// The equations of motion for one pressure and load over x = t/h.
class Equations {
  public:
    Equations(const CompliantLaw& law, const PressureArc& pressure, const LoadArc& load, double h)
        : law_(law), pressure_(pressure), load_(load), h_(h) {}

    bool held = false;  ///< the rim stands

    template <typename Number>
    Contact<Number> contact(const Vector<Number>& y, const Number& x) const {
        Contact<Number> c{};
        c.F_z = load_.base_N + x * load_.change_N - load_.lift_Ns2pm2 * y[kSpeed] * y[kSpeed];
        c.r = law_.free_radius_m - c.F_z / law_.stiffness_Npm;
        const Number& axle = y[law_.leg ? kAxle : kSpeed];
        const Number sliding = axle - y[law_.ring ? kBelt : kRim] * c.r;
        c.slip = value_of(axle) > kSlowest_mps ? Number(sliding / axle) : Number(sliding / kSlowest_mps);
        friction_at(law_.tyre, law_.relaxes ? y[kSlip] : c.slip, c.mu, c.mu_1);
        if (law_.wet) {
            const rig::WetGrip::Peak max = law_.wet->at(value_of(axle), law_.spun_up);
            c.mu *= law_.per_peak * (max.mu + max.mu_v * (axle - value_of(axle)));
        }
        c.F_x = c.F_z * c.mu;
        return c;
    }

    /// Torque by which the carcass drives the belt and holds the rim.
    template <typename Number>
    Number carcass_Nm(const Vector<Number>& y) const {
        return law_.twist_Nmprad * y[kTwist] + law_.twist_Nms * (y[kRim] - y[kBelt]);
    }

    template <typename Number>
    Vector<Number> rates(const Vector<Number>& y, const Number& x) const {
        const Contact<Number> c = contact(y, x);
        Vector<Number> f;
        f.setConstant(Number(0.0));
        const Number road = c.r * c.F_x;
        if (!held) {
            const BrakeTorque::Gain gain = law_.brake.gain(value_of(y[kSpeed]));
            const Number k_b = gain.k_b + gain.k_b1 * (y[kSpeed] - value_of(y[kSpeed]));
            const PressureArc& p = pressure_;
            const Number pressure = p.at(value_of(x)) + p.slope(value_of(x)) * (x - value_of(x));
            f[kRim] = ((law_.ring ? Number(-carcass_Nm(y)) : road) - k_b * pressure) / law_.rim_kgm2;
        }
        if (law_.ring) {
            f[kTwist] = y[kRim] - y[kBelt];
            f[kBelt] = (road + carcass_Nm(y)) / law_.belt_kgm2;
        }
        if (law_.leg) {
            const Number pull = law_.leg_Npm * y[kLeg] + law_.leg_Nspm * (y[kAxle] - y[kSpeed]);
            f[kSpeed] = pull / law_.aircraft_kg;
            f[kAxle] = -(c.F_x + pull) / law_.axle_kg;
            f[kLeg] = y[kAxle] - y[kSpeed];
        } else {
            f[kSpeed] = -c.F_x / law_.aircraft_kg;
        }
        if (law_.relaxes) {
            const rig::RelaxationParameters& p = law_.relaxation;
            const Number shrinking = p.length_m * c.mu_1 / law_.slope_at_rest;
            const Number sigma = value_of(shrinking) > p.floor_m ? shrinking : Number(p.floor_m);
            const Number& axle = y[law_.leg ? kAxle : kSpeed];
            const Number speed = value_of(axle) > kSlowest_mps ? axle : Number(kSlowest_mps);
            f[kSlip] = speed * (c.slip - y[kSlip]) / sigma;
        }
        return f;
    }

    Sums powers(const Motion& y, double x) const {
        const Contact<double> c = contact(y, x);
        const double axle = y[law_.leg ? kAxle : kSpeed];
        const double belt = y[law_.ring ? kBelt : kRim];
        const double twisting = y[kRim] - y[kBelt];
        const double bending = y[kAxle] - y[kSpeed];
        return {.distance_m = y[kSpeed],
                .angle_rad = y[kRim],
                .brake_J = held ? 0.0 : law_.brake.gain(y[kSpeed]).k_b * pressure_.at(x) * y[kRim],
                .tyre_J = c.F_x * (axle - belt * c.r) + (law_.ring ? law_.twist_Nms * twisting * twisting : 0.0),
                .friction_m = c.mu * y[kSpeed],
                .leg_J = law_.leg ? law_.leg_Nspm * bending * bending : 0.0};
    }

    double holding_margin_Nm(const Motion& y, double x) const {
        const Contact<double> c = contact(y, x);
        return law_.brake.gain(y[kSpeed]).k_b * pressure_.at(x) - (law_.ring ? -carcass_Nm(y) : c.r * c.F_x);
    }

    Motion step(const Motion& y, double x, double h, double& error) const {
        constexpr double kGamma = 0.25;
        constexpr int kStages = 6;
        constexpr double kAt[kStages] = {0.0, 0.386, 0.21, 0.63, 1.0, 1.0};
        constexpr double kDrift[kStages] = {0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0};
        constexpr double kA[kStages][kStages] = {{},
                                                 {1.544},
                                                 {0.9466785280815826, 0.2557011698983284},
                                                 {3.314825187068521, 2.896124015972201, 0.9986419139977817},
                                                 {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950},
                                                 {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1.0}};
        constexpr double kC[kStages][kStages] = {{},
                                                 {-5.6688},
                                                 {-2.430093356833875, -0.2063599157091915},
                                                 {-0.1073529058151375, -9.594562251023355, -20.47028614809616},
                                                 {7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160},
                                                 {8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054}};

        // Derivatives by the state and by x: pressure and load depend on time explicitly.
        using Dual = Eigen::AutoDiffScalar<Eigen::Matrix<double, kParts + 1, 1>>;
        Vector<Dual> at;
        for (int i = 0; i < kParts; ++i) at[i] = Dual(y[i], kParts + 1, i);
        const Vector<Dual> dual = rates<Dual>(at, Dual(x, kParts + 1, kParts));
        Matrix left;
        Motion f, drift;
        for (int i = 0; i < kParts; ++i) {
            f[i] = dual[i].value();
            left.row(i) = -dual[i].derivatives().head<kParts>().transpose();
            drift[i] = dual[i].derivatives()[kParts] / h_;
        }
        left.diagonal().array() += 1.0 / (kGamma * h);
        const Eigen::PartialPivLU<Matrix> factored(left);

        Motion u[kStages];
        for (int stage = 0; stage < kStages; ++stage) {
            Motion there = y, right = kDrift[stage] * h * drift;
            for (int j = 0; j < stage; ++j) {
                there += kA[stage][j] * u[j];
                right += kC[stage][j] / h * u[j];
            }
            right += stage == 0 ? f : rates<double>(there, x + kAt[stage] * h / h_);
            u[stage] = factored.solve(right);
        }
        Motion end = y;
        for (int j = 0; j < kStages - 1; ++j) end += kA[kStages - 1][j] * u[j];
        end += u[kStages - 1];

        // The last stage is the error of the method of order three. Each part is relative to its own scale: speeds to that of rolling, the twist to
        // the belt's rotation within its mode.
        const double v = std::max(y[kSpeed], 1.0);
        const double omega = v / law_.free_radius_m;
        Motion scale;
        scale << v, v, 0.01 * v, omega, 0.01 * omega, omega, 1.0;
        error = u[kStages - 1].cwiseQuotient(scale).cwiseAbs().maxCoeff();
        if (!(error >= 0.0)) error = std::numeric_limits<double>::max();
        return end;
    }

    /// What a step from `y` to `end` adds: Simpson's rule on the cubic between them.
    Sums sums(const Motion& y, const Motion& end, double x, double h) const {
        const double x1 = x + h / h_;
        const Motion bend = rates<double>(y, x) - rates<double>(end, x1);
        const Motion half = 0.5 * (y + end) + 0.125 * h * bend;
        const Sums a = powers(y, x), b = powers(half, x + 0.5 * h / h_), c = powers(end, x1);
        const auto integral = [&](double Sums::*of) { return h / 6.0 * (a.*of + 4.0 * (b.*of) + c.*of); };
        return {integral(&Sums::distance_m), integral(&Sums::angle_rad),  integral(&Sums::brake_J),
                integral(&Sums::tyre_J),     integral(&Sums::friction_m), integral(&Sums::leg_J)};
    }

  private:
    const CompliantLaw& law_;
    const PressureArc& pressure_;
    const LoadArc& load_;
    double h_;
};

}  // namespace

CompliantWheel::CompliantWheel(const rig::WheelParameters& parameters, const BrakeTorque& brake, const rig::TyreCurve& tyre, double tolerance)
    : law_{.ring = parameters.compliance.ring.belt_share > 0.0,
           .relaxes = parameters.compliance.relaxation.length_m > 0.0,
           .leg = parameters.compliance.leg.mass_kg > 0.0,
           .aircraft_kg = parameters.mass_kg - parameters.compliance.leg.mass_kg,
           .axle_kg = parameters.compliance.leg.mass_kg,
           .rim_kgm2 = parameters.inertia_kgm2 * (1.0 - parameters.compliance.ring.belt_share),
           .belt_kgm2 = parameters.inertia_kgm2 * parameters.compliance.ring.belt_share,
           .free_radius_m = parameters.free_radius_m,
           .stiffness_Npm = parameters.stiffness_Npm,
           .relaxation = parameters.compliance.relaxation,
           .tyre = {},
           .wet = {},
           .brake = brake},
      tolerance_(tolerance) {
    const auto& [ring, relaxation, leg] = parameters.compliance;
    const bool ring_can_be = ring.belt_share >= 0.0 && ring.belt_share < 1.0 && ring.damping >= 0.0 && (!law_.ring || ring.frequency_Hz > 0.0);
    const bool tread_can_be = relaxation.length_m >= 0.0 && (!law_.relaxes || relaxation.floor_m > 0.0);
    const bool leg_can_be = leg.mass_kg >= 0.0 && leg.mass_kg < parameters.mass_kg && leg.damping >= 0.0 && (!law_.leg || leg.frequency_Hz > 0.0);
    if (!ring_can_be || !tread_can_be || !leg_can_be) throw std::invalid_argument("compliance of tyre or leg is out of range: see compliance.hpp");
    if (law_.ring) {
        const double w = 2.0 * std::numbers::pi * ring.frequency_Hz;
        const double reduced = law_.rim_kgm2 * law_.belt_kgm2 / parameters.inertia_kgm2;
        law_.twist_Nmprad = w * w * reduced;
        law_.twist_Nms = 2.0 * ring.damping * w * reduced;
    }
    if (law_.leg) {
        const double w = 2.0 * std::numbers::pi * leg.frequency_Hz;
        law_.leg_Npm = w * w * leg.mass_kg;
        law_.leg_Nspm = 2.0 * leg.damping * w * leg.mass_kg;
    }
    set_tyre(tyre);
}

void CompliantWheel::set_tyre(const rig::TyreCurve& tyre) {
    law_.tyre = tyre;
    law_.slope_at_rest = rig::friction(tyre, 0.0).mu_1;
}

void CompliantWheel::set_surface(const rig::Surface& surface, bool spun_up) {
    set_tyre(surface.curve());
    law_.wet = surface.wet;
    law_.per_peak = 1.0 / rig::peak(surface).mu;
    law_.spun_up = spun_up;
}

void CompliantWheel::settle(const WheelState& state) {
    y_ = {};
    y_[kSpeed] = y_[kAxle] = state.v_mps;
    y_[kRim] = y_[kBelt] = state.omega_radps;
}

void CompliantWheel::advance(WheelState& state, const PressureArc& pressure, const LoadArc& load, double h) {
    Equations equations(law_, pressure, load, h);
    Motion y = Eigen::Map<const Motion>(y_.data());
    // An external change of the wheel's speeds since the last call (drive, drag) also applies to belt and axle.
    y[kAxle] += state.v_mps - y[kSpeed];
    y[kBelt] += state.omega_radps - y[kRim];
    y[kSpeed] = state.v_mps;
    y[kRim] = state.omega_radps;

    constexpr double kShortest_s = 1e-9;
    double done = 0.0;
    while (h - done > kShortest_s && y[kSpeed] > kSlowest_mps) {
        const double x = done / h;
        equations.held = y[kRim] <= 0.0 && equations.holding_margin_Nm(y, x) >= 0.0;
        double part = std::min(part_s_, h - done);
        double error = 0.0;
        Motion end = equations.step(y, x, part, error);
        ++steps_;
        const double next = part * std::clamp(0.9 * std::pow(error / tolerance_, -0.25), 0.2, 4.0);
        if (error > tolerance_ && part > kShortest_s) {
            part_s_ = next;
            continue;
        }
        // The step ends where a turning rim comes to rest, or a held one starts to turn.
        const auto passed = [&](const Motion& there, double x1) {
            return equations.held ? equations.holding_margin_Nm(there, x1) < 0.0 : there[kRim] < 0.0;
        };
        if (passed(end, x + part / h)) {
            double low = 0.0;
            while (part - low > kShortest_s) {
                const double middle = 0.5 * (low + part);
                (passed(equations.step(y, x, middle, error), x + middle / h) ? part : low) = middle;
            }
            end = equations.step(y, x, part, error);
            if (!equations.held) end[kRim] = 0.0;
        } else {
            part_s_ = part < part_s_ ? std::max(part_s_, next) : next;
        }
        const Sums sums = equations.sums(y, end, x, part);
        state.distance_m += sums.distance_m;
        state.angle_rad += sums.angle_rad;
        state.energy_brake_J += sums.brake_J;
        state.energy_tyre_J += sums.tyre_J;
        state.friction_distance_m += sums.friction_m;
        energy_leg_J_ += sums.leg_J;
        y = end;
        done += part;
    }
    Eigen::Map<Motion>(y_.data()) = y;
    state.v_mps = y[kSpeed];
    state.omega_radps = y[kRim];
    state.held = equations.held;
}

Forces CompliantWheel::forces(const WheelState& state, double pressure_Pa, const LoadArc& load) const {
    const Motion y = Eigen::Map<const Motion>(y_.data());
    const PressureArc none;
    const Equations equations(law_, none, load, 1.0);
    const Contact<double> c = equations.contact(y, 0.0);
    const double T_b = law_.brake.gain(state.v_mps).k_b * std::max(pressure_Pa, 0.0);
    const double on_rim = -equations.holding_margin_Nm(y, 0.0);
    const double slip = (state.v_mps - state.omega_radps * c.r) / std::max(state.v_mps, kSlowest_mps);
    return {slip, c.mu, c.F_x, c.F_z, c.r, state.held ? std::clamp(on_rim, -T_b, T_b) : T_b};
}

double CompliantWheel::energy_J(const WheelState& state) const {
    const auto half = [](double stiffness, double of) { return 0.5 * stiffness * of * of; };
    return half(law_.aircraft_kg, state.v_mps) + half(law_.rim_kgm2, state.omega_radps) +
           half(law_.belt_kgm2, y_[kBelt] + state.omega_radps - y_[kRim]) + half(law_.axle_kg, y_[kAxle] + state.v_mps - y_[kSpeed]) +
           half(law_.twist_Nmprad, y_[kTwist]) + half(law_.leg_Npm, y_[kLeg]);
}

}  // namespace plant
