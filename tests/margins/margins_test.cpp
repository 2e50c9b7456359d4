/// Nyquist's count and the margins, against loops whose margins are known in closed form.
#include "plant_sim/study/margins/margins.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "plant_sim/study/margins/limits.hpp"
#include "plant_sim/study/margins/pid_loop.hpp"
#include "plant_sim/study/margins/tune.hpp"
#include "tests/catch.hpp"

using namespace study::margins;

namespace {

constexpr double kPi = std::numbers::pi;

double dB(double gain) {
    return 20.0 * std::log10(gain);
}
double degrees(double radians) {
    return radians * 180.0 / kPi;
}

/// The root of a falling or rising `f` between `a` and `b`.
template <typename F>
double root(const F& f, double a, double b) {
    const bool sign = f(a) > 0.0;
    for (int i = 0; i < 200; ++i) {
        const double middle = 0.5 * (a + b);
        ((f(middle) > 0.0) == sign ? a : b) = middle;
    }
    return 0.5 * (a + b);
}

}  // namespace

TEST_CASE("integrator with delay: margins in closed form, stable up to k tau = pi / 2", "[STUDY-123]") {
    const double tau = 0.006;
    for (const double k : {1.0, 20.0, 100.0, 250.0}) {
        INFO("k " << k);
        const Margins m = margins(DelayLoop(k, {}, {0.0}, tau));
        CHECK(m.stable);
        CHECK(m.encirclements == 0);
        CHECK(m.phase_deg == Approx(90.0 - degrees(k * tau)).epsilon(1e-8));
        CHECK(m.crossover_radps == Approx(k).epsilon(1e-8));
        CHECK(m.gain_up_dB == Approx(dB(kPi / (2.0 * tau * k))).epsilon(1e-8));
        CHECK(m.upward_radps == Approx(kPi / (2.0 * tau)).epsilon(1e-8));
        CHECK(std::isinf(m.gain_down_dB));
    }
    // Each turn of the delay beyond pi / 2 + 2 pi n takes one more pair of poles over the axis.
    CHECK(margins(DelayLoop(1.01 * kPi / (2.0 * tau), {}, {0.0}, tau)).unstable_closed == 2);
    CHECK(margins(DelayLoop(1.01 * 5.0 * kPi / (2.0 * tau), {}, {0.0}, tau)).unstable_closed == 4);
    CHECK(margins(DelayLoop(1.01 * 9.0 * kPi / (2.0 * tau), {}, {0.0}, tau)).unstable_closed == 6);
}

TEST_CASE("two integrators: on the axis is not stable, with a zero it is", "[STUDY-123]") {
    CHECK_FALSE(margins(DelayLoop(4.0, {}, {0.0, 0.0}, 0.0)).stable);
    // L = k (s + z) / s^2: crossover and phase margin in closed form, no gain breaks it.
    const double k = 3.0, z = 2.0;
    const Margins m = margins(DelayLoop(k, {-z}, {0.0, 0.0}, 0.0));
    const double w2 = 0.5 * (k * k + std::sqrt(k * k * k * k + 4.0 * k * k * z * z));
    CHECK(m.stable);
    CHECK(m.phase_deg == Approx(degrees(std::atan(std::sqrt(w2) / z))).epsilon(1e-8));
    CHECK(std::isinf(m.gain_up_dB));
}

TEST_CASE("an unstable pole with delay: one encirclement, margins both ways", "[STUDY-123]") {
    const double p = 30.0, tau = 0.006;
    const auto loop = [&](double k) { return DelayLoop(k, {}, {p}, tau); };
    // On the negative real axis where atan(w / p) = w tau.
    const double w = root([&](double x) { return std::atan(x / p) - x * tau; }, 1.0, kPi / tau);
    const double max = std::hypot(w, p);
    for (const double k : {31.0, 60.0, 0.99 * max}) {
        INFO("k " << k);
        const Margins m = margins(loop(k));
        CHECK(m.stable);
        CHECK(m.unstable_poles == 1);
        CHECK(m.encirclements == 1);
        CHECK(m.gain_down_dB == Approx(dB(k / p)).margin(1e-5));
        CHECK(m.gain_up_dB == Approx(dB(max / k)).epsilon(1e-6));
        const double crossover = std::sqrt(k * k - p * p);
        CHECK(m.phase_deg == Approx(std::abs(degrees(std::atan(crossover / p) - crossover * tau))).epsilon(1e-6));
    }
    CHECK(margins(loop(0.99 * p)).unstable_closed == 1);
    CHECK(margins(loop(1.01 * max)).unstable_closed == 2);
    CHECK(std::isnan(margins(loop(0.99 * p)).phase_deg));
}

TEST_CASE("the count needs no luck with the grid: a resonance far sharper than its steps", "[STUDY-123]") {
    // L = k / (s (s^2 + 2 d s + 1)) encircles -1 between 1 - d and 1 + d, or nowhere: stable for k < 2 d.
    for (const double d : {1e-3, 1e-6, 1e-9}) {
        INFO("damping " << d);
        const Complex pole(-d, std::sqrt(1.0 - d * d));
        CHECK(margins(DelayLoop(1.98 * d, {}, {0.0, pole, std::conj(pole)}, 0.0)).stable);
        CHECK(margins(DelayLoop(2.02 * d, {}, {0.0, pole, std::conj(pole)}, 0.0)).unstable_closed == 2);
    }
}

TEST_CASE("a loop that no gain makes stable is called so", "[STUDY-123]") {
    // p tau > 1: no proportional gain holds an unstable pole behind a delay.
    const double tau = 0.006, p = 1.05 / tau;
    for (double k = 0.5 * p; k < 20.0 * p; k *= 1.1) CHECK_FALSE(margins(DelayLoop(k, {}, {p}, tau)).stable);
    CHECK_THROWS_AS(DelayLoop(1.0, {-1.0}, {-2.0}, 0.0), std::invalid_argument);
    CHECK_THROWS_AS(DelayLoop(1.0, {}, {-2.0}, -1e-3), std::invalid_argument);
}

TEST_CASE("the PID's loop is C(s) A(s) G(s), term by term", "[STUDY-123]") {
    const double line_s = GENERATE(0.0, 4e-3);
    const rig::ValveParameters valve{.natural_frequency_radps = 125.0, .damping = 0.8, .delay_s = 0.006, .line_s = line_s};
    OperatingPoint at;
    at.speed_mps = 20.0;
    at.slip = 0.24;
    at.mass_kg = 3000.0;
    at.inertia_kgm2 = 1.3;
    at.load_N = 28000.0;
    at.radius_m = 0.32;
    at.brake_gain_m3 = 1e-3;
    at.mu = 0.9;
    at.mu_1 = -0.4;
    for (const Pid& pid :
         {Pid{30.0, 0.0, 0.0, 0.0, 1.0}, Pid{30.0, 12.0, 0.0, 0.0, 0.5}, Pid{30.0, 12.0, 0.4, 0.002, 1.0}, Pid{30.0, 0.0, 0.4, 0.002, 0.0}}) {
        for (const auto linearisation : {Linearisation::printed, Linearisation::full}) {
            const DelayLoop loop = pid_loop(pid, valve, at, linearisation);
            for (const Complex s : {Complex(0.0, 3.0), Complex(0.0, 80.0), Complex(5.0, 400.0)}) {
                const double aircraft = linearisation == Linearisation::full ? at.mu : 0.0;
                const double a = at.load_N / (at.mass_kg * at.speed_mps) * (at.mu_1 * ((1.0 - at.slip) + at.mass_kg * 0.32 * 0.32 / 1.3) - aircraft);
                const Complex c = pid.k_p_per_s + pid.k_i_per_s2 / s + pid.k_d * s / (1.0 + s * pid.filter_s);
                const double schedule = 1.3 * 20.0 / (0.32 * 1e-3) * std::pow(20.0 / 40.0, pid.schedule - 1.0);
                const Complex valve_lag = 1e-3 * std::exp(-0.006 * s) / (1.0 + 2.0 * 0.8 * s / 125.0 + s * s / (125.0 * 125.0)) / (1.0 + s * line_s);
                const Complex wheel = 0.32 / (1.3 * 20.0) / (s + a);
                const Complex expected = schedule * c * valve_lag * wheel;
                CHECK(std::abs(loop.value(s) / expected - 1.0) < 1e-12);
            }
        }
    }
}

TEST_CASE("no controller beats the limits that are claimed for any", "[STUDY-123][figures]") {
    // Proportional gains alone come close to the phase limit only for slow poles; none may pass either limit.
    const double tau = 0.006;
    for (const double p : {5.0, 20.0, 60.0, 120.0}) {
        const Limits l = limits(-p, tau, 0.0);
        INFO("pole " << p << ", limits " << l.phase_deg << " deg, " << l.gain_range_dB << " dB");
        for (double k = 1.01 * p; k < 20.0 * p; k *= 1.02) {
            for (const double lead : {0.0, 1e-3, 3e-3, 6e-3}) {
                const Margins m =
                    lead > 0.0 ? margins(DelayLoop(k * lead / 5e-4, {-1.0 / lead}, {p, -2000.0}, tau)) : margins(DelayLoop(k, {}, {p}, tau));
                if (!m.stable) continue;
                CHECK(m.phase_deg < l.phase_deg);
                CHECK(m.gain_up_dB + m.gain_down_dB < l.gain_range_dB);
            }
        }
    }
    // Doyle, Francis and Tannenbaum's formulas at gamma = 2: 60 degrees, a range of 9.
    const Limits two = limits(-std::log(2.0) / tau, tau, 0.0);
    CHECK(two.phase_deg == Approx(60.0));
    CHECK(two.gain_range_dB == Approx(dB(9.0)));
    // A controller with a period waits for the next whole one.
    CHECK(limits(-10.0, 0.006, 1e-3).gamma == Approx(std::exp(0.07)));
    CHECK(limits(-10.0, 0.0065, 1e-3).gamma == Approx(std::exp(0.07)));
    CHECK(limits(-10.0, 0.006, static_cast<double>(1e-3F)).gamma == Approx(std::exp(0.07)).epsilon(1e-6));
    CHECK(limits(3.0, tau, 1e-3).phase_deg == 180.0);
    const Requirement r;
    // The fastest pole for 30 degrees, gamma = 1 / sin(15 deg), and for 6 dB, gamma = (k + 1) / (k - 1) with 20 log10(k) = 6.
    const double k = std::pow(10.0, r.gain_dB / 20.0);
    const double gamma = std::min(1.0 / std::sin(r.phase_deg * kPi / 360.0), (k + 1.0) / (k - 1.0));
    const double p = std::log(gamma) / 0.007;  // 6 ms behind a period of 1 ms
    CHECK(limits(-0.999 * p, tau, 1e-3).allow(r));
    CHECK_FALSE(limits(-1.001 * p, tau, 1e-3).allow(r));
}

TEST_CASE("the search finds the top of a hill, keeps to the box and repeats itself", "[STUDY-561]") {
    const std::vector<Parameter> parameters{{"a", 0.1, 100.0, 50.0}, {"b", 1.0, 10.0, 2.0}, {"c", 1e-3, 1.0, 0.5}};
    // A ridge with its top at (3, 4) inside and beyond the box in c.
    const auto hill = [](const std::vector<double>& x, double = 0.0) {
        const double a = std::log(x[0] / 3.0), b = std::log(x[1] / 4.0), c = std::log(x[2] / 2.0);
        return -a * a - 10.0 * (b - 0.3 * a) * (b - 0.3 * a) - c * c;
    };
    const Found found = search(parameters, hill, {.seed = 7, .population = 20, .generations = 60});
    CHECK(found.values[0] == Approx(3.0).epsilon(1e-2));
    CHECK(found.values[1] == Approx(4.0).epsilon(1e-2));
    CHECK(found.values[2] == Approx(1.0));
    CHECK(found.evaluations == 20 * 61);
    CHECK(search(parameters, hill, {.seed = 7, .population = 20, .generations = 60}).values == found.values);
    CHECK(search(parameters, hill, {.seed = 8, .population = 20, .generations = 2}).score >= hill({50.0, 2.0, 0.5}));
    CHECK_THROWS_AS(search({{"a", 1.0, 2.0, 3.0}}, hill, {}), std::invalid_argument);
    // More threads, and a judge that answers nothing but "worse" below what is to be beaten, lead to the same point.
    const auto curt = [&](const std::vector<double>& x, double to_beat) {
        const double s = hill(x);
        return s < to_beat ? to_beat - 1.0 : s;
    };
    const SearchOptions three{.seed = 7, .population = 20, .generations = 60, .threads = 3};
    CHECK(search(parameters, curt, three).values == found.values);
    const auto fails = [](const std::vector<double>&, double) -> double { throw std::runtime_error("no score"); };
    CHECK_THROWS_WITH(search(parameters, fails, three), "no score");
}

TEST_CASE("a climb ends where no single step of a kept digit is better", "[STUDY-561]") {
    const std::vector<Parameter> parameters{{"a", 0.1, 100.0}, {"b", 1e-3, 0.05}};
    const auto hill = [](const std::vector<double>& x, double) { return -std::abs(std::log(x[0] / 8.97)) - std::abs(std::log(x[1] / 0.00862)); };
    const SearchOptions digits{.digits = 3, .threads = 2};
    const Found top = climb(parameters, {20.0, 0.02}, hill, 1e-4, digits);
    CHECK(top.values == std::vector<double>{8.97, 0.00862});
    CHECK(climb(parameters, top.values, hill, 1e-4, digits).values == top.values);
    CHECK(climb(parameters, {8.96, 0.00862}, hill, 1e-4, digits).values == top.values);
    CHECK(climb(parameters, {8.96, 0.00862}, hill, 1.0, digits).values[0] == 8.96);  // not worth a step
    CHECK(climb({{"a", 0.1, 5.0}, parameters[1]}, {4.0, 0.02}, hill, 1e-4, digits).values == std::vector<double>{5.0, 0.00862});
    CHECK_THROWS_AS(climb(parameters, {1.0}, hill, 1e-4, digits), std::invalid_argument);
    CHECK(rounded(107.5999984, 3) == 108.0);
    CHECK(rounded(0.0086249, 3) == 0.00862);
    CHECK(rounded(99.96, 3) == 100.0);
}

TEST_CASE("a score is the least margin over what is asked, and below zero where nothing is stable", "[STUDY-561]") {
    Margins m;
    CHECK(score(m, {}) < 0.0);
    m.stable = true;
    m.phase_deg = 45.0;
    m.gain_up_dB = 3.0;
    m.gain_down_dB = std::numeric_limits<double>::infinity();
    CHECK(score(m, {.phase_deg = 30.0, .gain_dB = 6.0}) == Approx(0.5));
    CHECK(score(m, {.phase_deg = 90.0, .gain_dB = 4.0}) == Approx(0.5));
}
