/// The valve of eq. (6) against closed forms.
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include "plant_sim/model/rig.hpp"
#include "tests/catch.hpp"
#include "tests/model/scenarios.hpp"

namespace {

constexpr double kFull_Pa = 2.07e7;
constexpr rig::ValveParameters kValve{.natural_frequency_radps = 2.0 * std::numbers::pi * 20.0, .damping = 0.8, .delay_s = 6e-3};

/// Response of eq. (6) to a unit step at time zero, before the delay.
double step_response(const rig::ValveParameters& valve, double t) {
    t -= valve.delay_s;
    if (t <= 0.0) return 0.0;
    const double decay = valve.damping * valve.natural_frequency_radps;
    const double w_d = valve.natural_frequency_radps * std::sqrt(1.0 - valve.damping * valve.damping);
    return 1.0 - std::exp(-decay * t) * (std::cos(w_d * t) + decay / w_d * std::sin(w_d * t));
}

/// Response to a unit ramp: the integral of the step response.
double ramp_response(const rig::ValveParameters& valve, double t) {
    t -= valve.delay_s;
    if (t <= 0.0) return 0.0;
    const double w = valve.natural_frequency_radps;
    const double decay = valve.damping * w;
    const double w_d = w * std::sqrt(1.0 - valve.damping * valve.damping);
    const double lag = 2.0 * valve.damping / w;
    return t - lag + std::exp(-decay * t) * (lag * std::cos(w_d * t) + (lag * decay - 1.0) / w_d * std::sin(w_d * t));
}

/// The same behind a line, by the residues of w^2 a / ((s - p1) (s - p2) (s - p3) s), a = -p3 = 1 / line_s.
double step_behind_line(const rig::ValveParameters& valve, double t) {
    t -= valve.delay_s;
    if (t <= 0.0) return 0.0;
    using Complex = std::complex<double>;
    const double w = valve.natural_frequency_radps, a = 1.0 / valve.line_s;
    const double w_d = w * std::sqrt(1.0 - valve.damping * valve.damping);
    const std::array<Complex, 3> p{Complex(-valve.damping * w, w_d), Complex(-valve.damping * w, -w_d), -a};
    Complex sum = 1.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        Complex product = p[i];
        for (std::size_t j = 0; j < p.size(); ++j)
            if (j != i) product *= p[i] - p[j];
        sum += w * w * a / product * std::exp(p[i] * t);
    }
    return sum.real();
}

rig::ValveParameters with_delay(double delay_s) {
    rig::ValveParameters valve = kValve;
    valve.delay_s = delay_s;
    return valve;
}

constexpr std::array<double, 7> kDelays_s{0.0, 0.4e-3, 1e-3, 6e-3, 6.3e-3, 15.999e-3, 20e-3};
constexpr std::array<double, 4> kSteps_s{1e-4, 1e-3, 2e-3, 5e-3};

}  // namespace

TEST_CASE("valve: step response, whatever the delay and the step", "[RIG-040]") {
    for (const double delay_s : kDelays_s) {
        for (const double step_s : kSteps_s) {
            CAPTURE(delay_s, step_s);
            const rig::ValveParameters parameters = with_delay(delay_s);
            plant::Valve valve(parameters, step_s);
            CHECK(valve.first_s() >= 0.0);
            CHECK(valve.first_s() + valve.second_s() == Approx(step_s).epsilon(1e-12));
            double worst = 0.0;
            for (int i = 1; i * step_s < 0.15; ++i) {
                static_cast<void>(valve.advance(kFull_Pa, kFull_Pa));
                const double truth = kFull_Pa * step_response(parameters, i * step_s);
                worst = std::max(worst, std::abs(valve.pressure_Pa() - truth));
            }
            CHECK(worst < 1e-9 * kFull_Pa);
        }
    }
}

TEST_CASE("valve: the step response behind a line, whatever its lag, the delay and the step", "[RIG-040]") {
    for (const double line_s : {1e-4, 2e-3, 30e-3}) {
        for (const double delay_s : kDelays_s) {
            for (const double step_s : kSteps_s) {
                CAPTURE(line_s, delay_s, step_s);
                rig::ValveParameters parameters = with_delay(delay_s);
                parameters.line_s = line_s;
                plant::Valve valve(parameters, step_s);
                double worst = 0.0, seam = 0.0, last = 0.0;
                for (int i = 1; i * step_s < 0.2; ++i) {
                    const plant::Valve::Arcs arcs = valve.advance(kFull_Pa, kFull_Pa);
                    const double truth = kFull_Pa * step_behind_line(parameters, i * step_s);
                    worst = std::max(worst, std::abs(valve.pressure_Pa() - truth));
                    const plant::PressureArc& begins = valve.first_s() > 0.0 ? arcs.first : arcs.second;
                    seam = std::max({seam, std::abs(begins.at(0.0) - last), std::abs(arcs.second.at(1.0) - valve.pressure_Pa())});
                    last = valve.pressure_Pa();
                }
                CHECK(worst < 1e-9 * kFull_Pa);
                CHECK(seam < 1e-9 * kFull_Pa);
            }
        }
    }
}

TEST_CASE("valve: a line that hardly lags is none; a ramp comes later by its lag; one below zero is refused", "[RIG-040]") {
    rig::ValveParameters parameters = kValve;
    plant::Valve bare(parameters, 1e-3);
    parameters.line_s = 1e-7;
    plant::Valve short_line(parameters, 1e-3);
    parameters.line_s = 8e-3;
    plant::Valve line(parameters, 1e-3);
    constexpr double kRate = 5e7;
    for (int i = 0; i < 400; ++i) {
        const double from = kRate * i * 1e-3, to = kRate * (i + 1) * 1e-3;
        static_cast<void>(bare.advance(from, to));
        static_cast<void>(short_line.advance(from, to));
        static_cast<void>(line.advance(from, to));
        CHECK(short_line.pressure_Pa() == Approx(bare.pressure_Pa()).margin(2e-7 * kRate));
    }
    CHECK(bare.pressure_Pa() - line.pressure_Pa() == Approx(8e-3 * kRate).epsilon(1e-9));
    for (const double wrong : {-1e-3, std::nan("")}) {
        parameters.line_s = wrong;
        CHECK_THROWS_AS(plant::Valve(parameters, 1e-3), std::invalid_argument);
    }
}

TEST_CASE("valve: exact for an input that is linear in time", "[RIG-040]") {
    for (const double delay_s : kDelays_s) {
        for (const double step_s : kSteps_s) {
            CAPTURE(delay_s, step_s);
            const rig::ValveParameters parameters = with_delay(delay_s);
            plant::Valve valve(parameters, step_s);
            constexpr double kRate = 1e8;
            double worst = 0.0;
            for (int i = 1; i * step_s < 0.15; ++i) {
                static_cast<void>(valve.advance(kRate * (i - 1) * step_s, kRate * i * step_s));
                worst = std::max(worst, std::abs(valve.pressure_Pa() - kRate * ramp_response(parameters, i * step_s)));
            }
            CHECK(worst < 1e-9 * kRate * 0.15);
        }
    }
}

TEST_CASE("valve: any sequence of held commands is the sum of its steps", "[RIG-040]") {
    for (const double delay_s : kDelays_s) {
        CAPTURE(delay_s);
        const rig::ValveParameters parameters = with_delay(delay_s);
        plant::Valve valve(parameters, 1e-3);
        rig::Random random(7);
        std::vector<double> commands;
        double worst = 0.0;
        for (int i = 0; i < 200; ++i) {
            // Around a level at which the pressure does not run into zero.
            commands.push_back(1e7 + 2e6 * random.noise());
            static_cast<void>(valve.advance(commands.back(), commands.back()));
            double truth = 0.0;
            double before = 0.0;
            for (std::size_t k = 0; k < commands.size(); ++k) {
                const double since = static_cast<double>(commands.size() - k) * 1e-3;
                truth += (commands[k] - before) * step_response(parameters, since);
                before = commands[k];
            }
            worst = std::max(worst, std::abs(valve.pressure_Pa() - truth));
        }
        CHECK(worst < 1e-8 * kFull_Pa);
    }
}

TEST_CASE("valve: within a step the pressure follows the closed form to a millionth", "[RIG-040]") {
    for (const double delay_s : {6e-3, 6.3e-3}) {
        const rig::ValveParameters parameters = with_delay(delay_s);
        plant::Valve valve(parameters, 1e-3);
        double worst = 0.0;
        for (int i = 0; i < 100; ++i) {
            const plant::Valve::Arcs arcs = valve.advance(kFull_Pa, kFull_Pa);
            for (double x = 0.0; x <= 1.0; x += 0.125) {
                const double start = i * 1e-3;
                if (valve.first_s() > 0.0) {
                    const double truth = kFull_Pa * step_response(parameters, start + x * valve.first_s());
                    worst = std::max(worst, std::abs(arcs.first.at(x) - truth));
                }
                const double truth = kFull_Pa * step_response(parameters, start + valve.first_s() + x * valve.second_s());
                worst = std::max(worst, std::abs(arcs.second.at(x) - truth));
            }
        }
        CHECK(worst < 1e-6 * kFull_Pa);
    }
}

TEST_CASE("valve: pressure is never negative, though eq. (6) undershoots on release", "[RIG-040]") {
    plant::Valve valve(kValve, 1e-3);
    for (int i = 0; i < 200; ++i) static_cast<void>(valve.advance(kFull_Pa, kFull_Pa));
    double lowest_of_law = 0.0;
    for (int i = 0; i < 200; ++i) {
        const plant::Valve::Arcs arcs = valve.advance(0.0, 0.0);
        for (double x = 0.0; x <= 1.0; x += 0.1) {
            const auto& a = arcs.second;
            const double law = a.c0 + x * (a.c1 + x * (a.c2 + x * a.c3));
            lowest_of_law = std::min(lowest_of_law, law);
            CHECK(a.at(x) >= 0.0);
            if (law < 0.0) CHECK(a.slope(x) == 0.0);
        }
        CHECK(valve.pressure_Pa() >= 0.0);
    }
    // exp(-pi xi / sqrt(1 - xi^2)) = 1.5 % of undershoot is what had to be cut off.
    CHECK(lowest_of_law == Approx(-kFull_Pa * std::exp(-std::numbers::pi * 0.8 / 0.6)).epsilon(0.01));
}

TEST_CASE("valve: a part of an arc is the arc", "[RIG-040]") {
    const auto arc = plant::PressureArc::hermite(3e6, -1e9, 2e6, 2e9, 1e-3);
    CHECK(arc.at(0.0) == Approx(3e6));
    CHECK(arc.at(1.0) == Approx(2e6));
    CHECK(arc.slope(0.0) == Approx(-1e6));
    CHECK(arc.slope(1.0) == Approx(2e6));
    const plant::PressureArc part = arc.part(0.2, 0.7);
    const plant::LoadArc load{1000.0, 500.0, 2.0};
    for (double s = 0.0; s <= 1.0; s += 0.1) {
        CHECK(part.at(s) == Approx(arc.at(0.2 + 0.5 * s)).epsilon(1e-13));
        CHECK(part.slope(s) == Approx(0.5 * arc.slope(0.2 + 0.5 * s)).epsilon(1e-12).margin(1e-6));
        CHECK(load.part(0.2, 0.7).force_N(s, 3.0) == Approx(load.force_N(0.2 + 0.5 * s, 3.0)).epsilon(1e-14));
    }
}

TEST_CASE("valve: parameters that it cannot integrate are refused", "[RIG-040]") {
    rig::ValveParameters valve = kValve;
    for (const double damping : {0.0, 1.0, 1.5, -0.1, std::nan("")}) {
        valve.damping = damping;
        CHECK_THROWS_AS(plant::Valve(valve, 1e-3), std::invalid_argument);
    }
}

TEST_CASE("static map: dead zone, points, linear between, saturating", "[RIG-040]") {
    const rig::PressureMap map = rig::load_rig("config", {}).rig.pressure_map;
    const auto& points = map.points();
    CHECK(points.front().current_mA == 3.0);
    CHECK(points.back().current_mA == 40.0);
    CHECK(map.pressure_Pa(-5.0) == 0.0);
    CHECK(map.pressure_Pa(0.0) == 0.0);
    CHECK(map.pressure_Pa(3.0) == 0.0);
    CHECK(map.pressure_Pa(std::nextafter(3.0, 4.0)) > 0.0);
    CHECK(map.pressure_Pa(40.0) == kFull_Pa);
    CHECK(map.pressure_Pa(std::nextafter(40.0, 0.0)) == Approx(kFull_Pa));
    CHECK(map.pressure_Pa(1e9) == kFull_Pa);
    for (std::size_t i = 1; i < points.size(); ++i) {
        CHECK(map.pressure_Pa(points[i].current_mA) == points[i].pressure_Pa);
        CHECK(map.pressure_Pa(0.5 * (points[i].current_mA + points[i - 1].current_mA)) ==
              Approx(0.5 * (points[i].pressure_Pa + points[i - 1].pressure_Pa)).epsilon(1e-14));
    }
    double last = -1.0;
    for (double mA = 0.0; mA <= 45.0; mA += 0.01) {
        CHECK(map.pressure_Pa(mA) >= last);
        last = map.pressure_Pa(mA);
    }
    using Points = std::vector<rig::PressureMap::Point>;
    CHECK_THROWS_AS(rig::PressureMap(Points{{3.0, 0.0}}), std::invalid_argument);
    CHECK_THROWS_AS(rig::PressureMap(Points{{3.0, 0.0}, {3.0, 1.0}}), std::invalid_argument);
    CHECK_THROWS_AS(rig::PressureMap(Points{{3.0, 2.0}, {4.0, 1.0}}), std::invalid_argument);
    CHECK_THROWS_AS(rig::PressureMap(Points{{3.0, 0.0}, {std::nan(""), 1.0}}), std::invalid_argument);
    CHECK_THROWS_AS(rig::PressureMap(Points{{3.0, 0.0}, {4.0, std::nan("")}}), std::invalid_argument);
}

TEST_CASE("valve: play before the map shows as two branches", "[STUDY-100]") {
    constexpr double kWidth_mA = 0.8;
    rig::RigParameters parameters = rig::load_rig("config", {}).rig;
    parameters.valve.hysteresis_mA = kWidth_mA;
    plant::Rig rig(parameters, 1e-3, 1);
    rig.start_at_rest();
    const auto settle = [&rig](double from_mA, double to_mA) {
        for (int i = 0; i <= 1000; ++i) rig.advance_current(from_mA + (to_mA - from_mA) * std::min(1.0, i / 200.0));
        return rig.pressure_Pa();
    };
    const rig::PressureMap& map = parameters.pressure_map;
    CHECK(settle(0.0, 20.0) == Approx(map.pressure_Pa(20.0 - 0.5 * kWidth_mA)));
    static_cast<void>(settle(20.0, 40.0));
    CHECK(settle(40.0, 20.0) == Approx(map.pressure_Pa(20.0 + 0.5 * kWidth_mA)));
    // Turning within the band moves nothing.
    CHECK(settle(20.0, 20.0 + 0.9 * kWidth_mA) == Approx(map.pressure_Pa(20.0 + 0.5 * kWidth_mA)));

    plant::Play none(0.0);
    rig::Random random(7);
    for (int i = 0; i < 1000; ++i) {
        const double current_mA = 20.0 + 5.0 * random.noise();
        CHECK(none.follow(current_mA) == current_mA);
    }
}
