#include "tests/model/reference/reference_plant.hpp"

#include <cvodes/cvodes.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace reference {

namespace {

constexpr int kStates = 4;  // v, omega, p, dp/dt
constexpr int kIntegrals = 5;
constexpr double kNoTime_s = 1e-12;
#if defined(SUN_COMM_NULL)
const SUNComm kNoCommunicator = SUN_COMM_NULL;
#else  // SUNDIALS before 7
constexpr std::nullptr_t kNoCommunicator = nullptr;
#endif
enum Root { kLock, kRelease, kEnd, kEmpty, kRoots };

/// The equations as the paper prints them.
class Equations {
  public:
    explicit Equations(const rig::RigParameters& p, Input input)
        : J_w_(p.wheel.inertia_kgm2),
          m_a_(p.wheel.mass_kg),
          r_0_(p.wheel.free_radius_m),
          k_r_(p.wheel.stiffness_Npm),
          base_(p.load.base_N),
          half_rho_S_C_l_(p.load.lift_Ns2pm2),
          surface_(p.surface),
          geometry_(p.brake.piston_area_m2 * p.brake.pistons * p.brake.surfaces * p.brake.effective_radius_m),
          curve_(p.friction_curve),
          speed_(p.brake_on_mps),
          omega_n_(p.valve.natural_frequency_radps),
          xi_(p.valve.damping),
          input_(input) {
        const double mean = curve_[0] + curve_[1] / 2.0 + curve_[2] / 3.0 + curve_[3] / 4.0;
        bias_ = p.mean_friction - mean;
    }

    [[nodiscard]] double F_z(double v) const { return base_ - half_rho_S_C_l_ * v * v; }
    [[nodiscard]] double radius(double v) const { return r_0_ - F_z(v) / k_r_; }
    [[nodiscard]] double slip(double v, double omega) const { return (v - omega * radius(v)) / v; }
    [[nodiscard]] double mu(double lambda) const {
        const double l = std::fabs(lambda);
        const double value = surface_.c1 * -std::expm1(-surface_.c2 * l) - surface_.c3 * l;
        return lambda < 0.0 ? -value : value;
    }
    [[nodiscard]] double mu_b(double v) const {
        const double x = std::min(v / speed_, 1.0);
        return bias_ + curve_[0] + curve_[1] * x + curve_[2] * x * x + curve_[3] * x * x * x;
    }
    [[nodiscard]] double torque(double v, double pressure) const { return mu_b(v) * geometry_ * std::max(pressure, 0.0); }
    /// Above zero the tyre turns a wheel that stands.
    [[nodiscard]] double turning_margin(double v, double pressure) const { return radius(v) * F_z(v) * mu(1.0) - torque(v, pressure); }
    [[nodiscard]] bool filters() const { return input_ == Input::valve; }

    // The input is linear over the present segment.
    void set_segment(double time, double value, double slope) {
        segment_time_ = time;
        segment_value_ = value;
        segment_slope_ = slope;
    }
    void set_held(bool held) { held_ = held; }
    [[nodiscard]] bool held() const { return held_; }
    [[nodiscard]] double input(double t) const { return segment_value_ + segment_slope_ * (t - segment_time_); }
    [[nodiscard]] double pressure(double t, const double* y) const { return input_ == Input::pressure ? input(t) : y[2]; }

    void derivatives(double t, const double* y, double* dy) const {
        const double v = y[0];
        const double omega = held_ ? 0.0 : y[1];
        const double F_x = F_z(v) * mu(slip(v, omega));
        dy[0] = -F_x / m_a_;
        dy[1] = held_ ? 0.0 : (radius(v) * F_x - torque(v, pressure(t, y))) / J_w_;
        dy[2] = input_ == Input::pressure ? 0.0 : y[3];
        dy[3] = input_ == Input::pressure ? 0.0 : omega_n_ * omega_n_ * (input(t) - y[2] - 2.0 * xi_ / omega_n_ * y[3]);
    }
    void integrands(double t, const double* y, double* dq) const {
        const double v = y[0];
        const double omega = held_ ? 0.0 : y[1];
        const double lambda = slip(v, omega);
        dq[0] = v;
        dq[1] = omega;
        dq[2] = torque(v, pressure(t, y)) * omega;
        dq[3] = F_z(v) * mu(lambda) * lambda * v;
        dq[4] = mu(lambda) * v;
    }

  private:
    double J_w_, m_a_, r_0_, k_r_, base_, half_rho_S_C_l_;
    rig::Surface surface_;
    double geometry_;
    rig::FrictionCurve curve_;
    double speed_, omega_n_, xi_;
    Input input_;
    double bias_ = 0.0;
    double segment_time_ = 0.0, segment_value_ = 0.0, segment_slope_ = 0.0;
    bool held_ = false;
};

void check(int flag, const char* what) {
    if (flag < 0) throw std::runtime_error(std::string("CVODES: ") + what + " failed with " + std::to_string(flag));
}

/// Owns one CVODES instance with its vectors.
class Solver {
  public:
    Solver(Equations& equations, const Options& options, const std::array<double, kStates>& start)
        : equations_(equations), until_mps_(options.until_mps) {
        const double relative_tolerance = options.relative_tolerance;
        check(SUNContext_Create(kNoCommunicator, &context_), "context");
        y_ = N_VNew_Serial(kStates, context_);
        q_ = N_VNew_Serial(kIntegrals, context_);
        N_Vector tolerance = N_VClone(y_);
        N_Vector integral_tolerance = N_VClone(q_);
        std::copy(start.begin(), start.end(), N_VGetArrayPointer(y_));
        N_VConst(0.0, q_);
        const double scale = relative_tolerance;
        const std::array<double, kStates> absolute{scale, scale, 1e6 * scale, 1e8 * scale};
        std::copy(absolute.begin(), absolute.end(), N_VGetArrayPointer(tolerance));
        const std::array<double, kIntegrals> integral_absolute{scale, scale, 1e3 * scale, 1e3 * scale, scale};
        std::copy(integral_absolute.begin(), integral_absolute.end(), N_VGetArrayPointer(integral_tolerance));
        memory_ = CVodeCreate(CV_BDF, context_);
        check(CVodeInit(memory_, derivative_callback, 0.0, y_), "init");
        check(CVodeSVtolerances(memory_, relative_tolerance, tolerance), "tolerances");
        check(CVodeSetUserData(memory_, this), "user data");
        check(CVodeSetMaxNumSteps(memory_, 10000000), "step limit");
        matrix_ = SUNDenseMatrix(kStates, kStates, context_);
        linear_ = SUNLinSol_Dense(y_, matrix_, context_);
        check(CVodeSetLinearSolver(memory_, linear_, matrix_), "linear solver");
        check(CVodeQuadInit(memory_, integral_callback, q_), "integrals");
        check(CVodeQuadSVtolerances(memory_, relative_tolerance, integral_tolerance), "integral tolerances");
        check(CVodeSetQuadErrCon(memory_, options.integrals_decide ? 1 : 0), "integral error control");
        check(CVodeRootInit(memory_, kRoots, roots_callback), "roots");
        std::array<int, kRoots> direction{-1, 1, -1, 0};
        check(CVodeSetRootDirection(memory_, direction.data()), "root directions");
        check(CVodeSetNoInactiveRootWarn(memory_), "root warnings");
        N_VDestroy(tolerance);
        N_VDestroy(integral_tolerance);
    }
    ~Solver() {
        CVodeFree(&memory_);
        SUNLinSolFree(linear_);
        SUNMatDestroy(matrix_);
        N_VDestroy(y_);
        N_VDestroy(q_);
        SUNContext_Free(&context_);
    }
    Solver(const Solver&) = delete;
    Solver& operator=(const Solver&) = delete;

    [[nodiscard]] double* y() { return N_VGetArrayPointer(y_); }
    [[nodiscard]] const double* q() { return N_VGetArrayPointer(q_); }

    void restart(double t) {
        check(CVodeReInit(memory_, t, y_), "restart");
        check(CVodeQuadReInit(memory_, q_), "restart of integrals");
    }
    void stop_at(double t) { check(CVodeSetStopTime(memory_, t), "stop time"); }
    int advance(double to, double& t) {
        const int flag = CVode(memory_, to, y_, &t, CV_NORMAL);
        check(flag, "step");
        double at = t;
        check(CVodeGetQuad(memory_, &at, q_), "integrals");
        return flag;
    }
    [[nodiscard]] bool root(Root index) {
        std::array<int, kRoots> found{};
        check(CVodeGetRootInfo(memory_, found.data()), "root info");
        return found.at(static_cast<std::size_t>(index)) != 0;
    }

  private:
    static int derivative_callback(sunrealtype t, N_Vector y, N_Vector dy, void* user) {
        static_cast<Solver*>(user)->equations_.derivatives(t, N_VGetArrayPointer(y), N_VGetArrayPointer(dy));
        return 0;
    }
    static int integral_callback(sunrealtype t, N_Vector y, N_Vector dq, void* user) {
        static_cast<Solver*>(user)->equations_.integrands(t, N_VGetArrayPointer(y), N_VGetArrayPointer(dq));
        return 0;
    }
    static int roots_callback(sunrealtype t, N_Vector y, sunrealtype* g, void* user) {
        const auto* self = static_cast<const Solver*>(user);
        const double* s = N_VGetArrayPointer(y);
        const Equations& e = self->equations_;
        g[kLock] = e.held() ? 1.0 : s[1];
        g[kRelease] = e.held() ? e.turning_margin(s[0], e.pressure(t, s)) : -1.0;
        g[kEnd] = s[0] - self->until_mps_;
        g[kEmpty] = e.filters() ? s[2] : 1.0;
        return 0;
    }

    Equations& equations_;
    double until_mps_;
    SUNContext context_ = nullptr;
    N_Vector y_ = nullptr;
    N_Vector q_ = nullptr;
    SUNMatrix matrix_ = nullptr;
    SUNLinearSolver linear_ = nullptr;
    void* memory_ = nullptr;
};

}  // namespace

double value_before(const Profile& profile, double time_s) {
    if (time_s <= profile.front().time_s) return profile.front().value;
    for (std::size_t i = 1; i < profile.size(); ++i) {
        if (time_s > profile[i].time_s) continue;
        const Knot& a = profile[i - 1];
        const Knot& b = profile[i];
        return a.value + (b.value - a.value) * (time_s - a.time_s) / (b.time_s - a.time_s);
    }
    return profile.back().value;
}

double value_after(const Profile& profile, double time_s) {
    if (time_s >= profile.back().time_s) return profile.back().value;
    for (std::size_t i = 1; i < profile.size(); ++i) {
        if (time_s >= profile[i].time_s) continue;
        const Knot& a = profile[i - 1];
        const Knot& b = profile[i];
        if (time_s < a.time_s) return a.value;
        return a.value + (b.value - a.value) * (time_s - a.time_s) / (b.time_s - a.time_s);
    }
    return profile.back().value;
}

Motion integrate(const rig::RigParameters& parameters, Input input, const Profile& profile, const Options& options,
                 const std::function<void(const Motion&)>& output) {
    Equations equations(parameters, input);
    const double delay = input == Input::valve ? parameters.valve.delay_s : 0.0;
    Profile acting;
    if (input == Input::valve) acting = {{0.0, 0.0}, {delay, 0.0}};
    for (const Knot& knot : profile) acting.push_back({knot.time_s + delay, knot.value});
    const double v_0 = parameters.brake_on_mps;
    const double omega_0 = options.from_rest ? 0.0 : v_0 / equations.radius(v_0);
    Solver solver(equations, options, {v_0, omega_0, 0.0, 0.0});

    std::size_t next_knot = 0;
    // Moves on to the segment that begins at `t`.
    const auto enter_segment = [&](double t) {
        while (next_knot < acting.size() && acting[next_knot].time_s <= t) ++next_knot;
        const Knot& a = acting[next_knot == 0 ? 0 : next_knot - 1];
        const bool last = next_knot == 0 || next_knot == acting.size();
        const double slope = last ? 0.0 : (acting[next_knot].value - a.value) / (acting[next_knot].time_s - a.time_s);
        equations.set_segment(a.time_s, a.value, slope);
        const double* y = solver.y();
        equations.set_held(y[1] <= 0.0 && equations.turning_margin(y[0], equations.pressure(t, y)) <= 0.0);
        solver.restart(t);
        solver.stop_at(next_knot < acting.size() ? acting[next_knot].time_s : options.longest_s);
    };
    const auto motion = [&](double t) {
        const double* y = solver.y();
        const double* q = solver.q();
        return Motion{
            t, y[0], equations.held() ? 0.0 : y[1], std::max(equations.pressure(t, y), 0.0), q[0], q[1], q[2], q[3], q[4], equations.held()};
    };

    double t = 0.0;
    enter_segment(t);
    output(motion(t));
    for (std::int64_t next_output = 1; t < options.longest_s;) {
        const double output_at = static_cast<double>(next_output) * options.output_s;
        const double segment_end = next_knot < acting.size() ? acting[next_knot].time_s : options.longest_s;
        const double target = std::min({output_at, segment_end, options.longest_s});
        // CVODES refuses to start for a distance that is lost in rounding.
        int flag = CV_SUCCESS;
        if (target - t < kNoTime_s)
            t = target;
        else
            flag = solver.advance(target, t);
        if (flag == CV_ROOT_RETURN) {
            if (solver.root(kEnd)) return motion(t);
            if (solver.root(kLock)) {
                solver.y()[1] = 0.0;
                equations.set_held(true);
            } else if (solver.root(kRelease)) {
                equations.set_held(false);
            }
            solver.restart(t);
            continue;
        }
        if (t >= output_at) {
            output(motion(t));
            ++next_output;
        }
        if (t >= segment_end) enter_segment(t);
    }
    return motion(t);
}

double kinetic_energy_J(const rig::RigParameters& parameters, const Motion& motion) {
    return 0.5 * parameters.wheel.mass_kg * motion.v_mps * motion.v_mps +
           0.5 * parameters.wheel.inertia_kgm2 * motion.omega_radps * motion.omega_radps;
}

}  // namespace reference
