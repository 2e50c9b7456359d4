/// bench_plant: the plant alone, open loop, against general-purpose integrators on the same equations: work over precision. See --help.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/bench/measure.hpp"
#include "plant_sim/bench/odeint_plant.hpp"
#include "plant_sim/model/open_loop.hpp"
#include "rig_bridge/pictures/figure.hpp"
#include "rig_bridge/rig/load_rig.hpp"
#include "tests/model/reference/profiles.hpp"
#include "tests/model/reference/reference_plant.hpp"

namespace {

using reference::Profile;

constexpr const char* kOurs = "this plant";
constexpr const char* kFixed = "its fixed step";
constexpr const char* kOdeint = "odeint dopri5";
constexpr const char* kCvode = "CVODE";
constexpr std::array<const char*, 4> kMethods{kOurs, kFixed, kOdeint, kCvode};
constexpr double kOutput_s = 5e-3;

/// One open-loop run: static pressure before the valve, from brake-on to 5 m/s or `end_s`.
struct Case {
    rig::RigParameters rig;
    Profile static_Pa;
    double end_s;
};

struct Sample {
    double v, omega;
};
using Trajectory = std::vector<Sample>;

/// Held commands, as a controller sends them, all below the peak.
Profile stairs(double peak_Pa) {
    Profile p{{0.0, 0.0}};
    for (int i = 0; i < 80; ++i) {
        const double at_s = static_cast<double>(100 + 250 * i) * 1e-3;
        p.push_back({at_s, p.back().value});
        p.push_back({at_s, (0.5 + 0.4 * std::sin(2.0 * i)) * peak_Pa});
    }
    return p;
}

std::vector<Case> cases(double longest_s) {
    std::vector<Case> all;
    for (const std::string& surface : rig::surface_names("config")) {
        for (const std::string& maneuver : rig::maneuver_names("config")) {
            rig::ManeuverChoice choice;
            choice.surface = surface;
            choice.maneuver = maneuver;
            const rig::RigParameters rig = rig::load_rig("config", choice).rig;
            const auto shapes = profiles(rig);
            for (const Profile& profile : {shapes.at(0).pressure_Pa, shapes.at(1).pressure_Pa, stairs(min_peak_pressure_Pa(rig))}) {
                reference::Options options;
                options.longest_s = longest_s;
                options.output_s = 1.0;
                const double end_s = reference::integrate(rig, reference::Input::valve, profile, options, [](const auto&) {}).time_s;
                all.push_back({rig, profile, std::floor(end_s * 100.0) * 0.01});
            }
        }
    }
    return all;
}

/// Valve and wheel of plant_sim/model on a fixed step, without sensors.
void run_fixed(const Case& c, double output_s, double step_s, Trajectory& out) {
    plant::Wheel wheel(c.rig.wheel, plant::BrakeTorque(c.rig.brake, c.rig.friction_curve, c.rig.mean_friction, c.rig.brake_on_mps), c.rig.surface);
    plant::Valve valve(c.rig.valve, step_s);
    const plant::LoadArc load{c.rig.load.base_N, 0.0, c.rig.load.lift_Ns2pm2};
    plant::WheelState state;
    state.v_mps = c.rig.brake_on_mps;
    state.omega_radps = bench::Equations(c.rig).rolling_radps(state.v_mps);
    state.held = false;
    out.push_back({state.v_mps, state.omega_radps});
    const auto steps = std::lround(c.end_s / step_s), each = std::lround(output_s / step_s);
    std::size_t knot = 0;
    const auto& p = c.static_Pa;
    // The value right after `t`, or right before it where the profile jumps there.
    const auto value = [&](double t, bool after) {
        while (knot + 1 < p.size() && (after ? p[knot + 1].time_s <= t + 1e-9 : p[knot + 1].time_s < t - 1e-9)) ++knot;
        if (knot + 1 == p.size()) return p[knot].value;
        const double span = p[knot + 1].time_s - p[knot].time_s;
        return p[knot].value + (p[knot + 1].value - p[knot].value) * (t - p[knot].time_s) / span;
    };
    for (std::int64_t i = 0; i < steps; ++i) {
        const double from = value(static_cast<double>(i) * step_s, true);
        const double to = value(static_cast<double>(i + 1) * step_s, false);
        const plant::Valve::Arcs arcs = valve.advance(from, to);
        if (valve.first_s() > 0.0) wheel.advance(state, arcs.first, load, valve.first_s());
        wheel.advance(state, arcs.second, load, valve.second_s());
        if ((i + 1) % each == 0) out.push_back({state.v_mps, state.omega_radps});
    }
}

/// The same with steps as long as the motion allows.
void run_open_loop(const Case& c, double step_s, double tolerance, Trajectory& out) {
    std::vector<plant::OpenLoop::Point> points;
    points.reserve(c.static_Pa.size());
    for (const reference::Knot& k : c.static_Pa) points.push_back({k.time_s, k.value});
    plant::OpenLoop plant(c.rig, plant::OpenLoop::Input::valve, points, tolerance);
    out.push_back({plant.wheel().v_mps, plant.wheel().omega_radps});
    for (std::size_t next = 1; plant.step(c.end_s);) {
        for (; static_cast<double>(next) * step_s <= plant.time_s() + 1e-12; ++next) {
            const plant::OpenLoop::Sample sample = plant.at(static_cast<double>(next) * step_s);
            out.push_back({sample.v_mps, sample.omega_radps});
        }
    }
}

void run_cvode(const Case& c, double step_s, double tolerance, bool integrals_decide, Trajectory& out) {
    reference::Options options;
    options.relative_tolerance = tolerance;
    options.until_mps = 1.0;
    options.longest_s = c.end_s + 0.5 * step_s;
    options.output_s = step_s;
    options.integrals_decide = integrals_decide;
    reference::integrate(c.rig, reference::Input::valve, c.static_Pa, options, [&](const reference::Motion& m) {
        out.push_back({m.v_mps, m.omega_radps});
    });
}

void run_odeint(const Case& c, double step_s, double tolerance, Trajectory& out) {
    namespace odeint = boost::numeric::odeint;
    bench::Equations equations(c.rig);
    bench::OdeState x{};
    x[bench::kSpeed] = c.rig.brake_on_mps;
    x[bench::kOmega] = equations.rolling_radps(c.rig.brake_on_mps);
    auto stepper = odeint::make_dense_output(tolerance, tolerance, bench::Dopri5());
    Profile acting{{0.0, 0.0}};
    for (const reference::Knot& k : c.static_Pa) acting.push_back({k.time_s + c.rig.valve.delay_s, k.value});
    out.push_back({x[bench::kSpeed], x[bench::kOmega]});
    std::size_t next = 1;
    bench::OdeState at{};
    for (std::size_t k = 0; k < acting.size(); ++k) {
        const double from_s = acting[k].time_s;
        const double to_s = std::min(k + 1 < acting.size() ? acting[k + 1].time_s : c.end_s, c.end_s);
        if (to_s <= from_s) continue;
        equations.start_s = from_s;
        equations.start_Pa = acting[k].value;
        equations.slope_Paps = k + 1 < acting.size() ? (acting[k + 1].value - acting[k].value) / (acting[k + 1].time_s - from_s) : 0.0;
        stepper.initialize(x, from_s, 1e-5);
        while (stepper.current_time() < to_s) {
            const double left_s = to_s - stepper.current_time();
            if (stepper.current_time_step() > left_s) stepper.initialize(bench::OdeState(stepper.current_state()), stepper.current_time(), left_s);
            stepper.do_step(std::cref(equations));
            for (; static_cast<double>(next) * step_s <= stepper.current_time() + 1e-12; ++next) {
                stepper.calc_state(static_cast<double>(next) * step_s, at);
                out.push_back({at[bench::kSpeed], at[bench::kOmega]});
            }
            if (left_s < 1e-12) break;
        }
        x = stepper.current_state();
    }
}

/// One integrator with one step or tolerance.
struct Candidate {
    std::string method, setting;
    std::function<void(const Case&, double output_s, Trajectory&)> run;
    std::vector<double> seconds{};  // of each round
    double error_v = 0.0, error_omega = 0.0;

    [[nodiscard]] double median_s() const { return bench::median(seconds); }
};

std::vector<Candidate> candidates() {
    std::vector<Candidate> all;
    for (const double tolerance : {1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9})
        all.push_back({kOurs, fmt::format("tolerance {:.0e}", tolerance),
                       [=](const Case& c, double output_s, Trajectory& out) { run_open_loop(c, output_s, tolerance, out); }});
    for (const double step_s : {5e-3, 2.5e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4})
        all.push_back({kFixed, fmt::format("{:g} ms", step_s * 1e3),
                       [=](const Case& c, double output_s, Trajectory& out) { run_fixed(c, output_s, step_s, out); }});
    for (const double tolerance : {1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10})
        all.push_back({kOdeint, fmt::format("tolerance {:.0e}", tolerance),
                       [=](const Case& c, double output_s, Trajectory& out) { run_odeint(c, output_s, tolerance, out); }});
    for (const double tolerance : {1e-4, 1e-5, 1e-6, 1e-7, 1e-8})
        all.push_back({kCvode, fmt::format("tolerance {:.0e}", tolerance),
                       [=](const Case& c, double output_s, Trajectory& out) { run_cvode(c, output_s, tolerance, false, out); }});
    return all;
}

void judge(Candidate& one, const Case& c, double output_s, const Trajectory& truth) {
    Trajectory mine;
    one.run(c, output_s, mine);
    const bench::Equations equations(c.rig);
    for (std::size_t i = 0; i < std::min(mine.size(), truth.size()); ++i) {
        one.error_v = std::max(one.error_v, std::abs(mine[i].v / truth[i].v - 1.0));
        one.error_omega = std::max(one.error_omega, std::abs(mine[i].omega - truth[i].omega) / equations.rolling_radps(truth[i].v));
    }
    if (mine.size() + 1 < truth.size()) one.error_v = one.error_omega = 1.0;
}

/// How long `method` takes for an error: between its settings linear in the logarithms, less than the coarsest at most; NaN beyond the
/// finest.
double seconds_for(const std::vector<Candidate>& all, const std::string& method, double error_omega) {
    std::vector<std::pair<double, double>> curve;  // error and time, the smallest error first
    for (const Candidate& one : all)
        if (one.method == method) curve.emplace_back(std::log(one.error_omega), std::log(one.median_s()));
    std::sort(curve.begin(), curve.end());
    // Whoever is slower for a larger error is not on the curve.
    double best = std::numeric_limits<double>::infinity();
    for (auto& [error, seconds] : curve) best = seconds = std::min(best, seconds);
    const double wanted = std::log(error_omega);
    if (wanted < curve.front().first) return std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = 1; i < curve.size(); ++i) {
        if (wanted > curve[i].first) continue;
        const auto& [e0, t0] = curve[i - 1];
        const auto& [e1, t1] = curve[i];
        return std::exp(t0 + (t1 - t0) * (wanted - e0) / (e1 - e0));
    }
    return std::exp(curve.back().second);
}

void draw(const std::vector<Candidate>& all, double simulated_s, const std::filesystem::path& png) {
    std::vector<pictures::Series> curves;
    for (std::size_t i = 0; i < kMethods.size(); ++i) {
        pictures::Series& curve = curves.emplace_back(pictures::Series{.name = kMethods.at(i), .colour = i});
        for (const Candidate& one : all)
            if (one.method == kMethods.at(i)) curve.add(one.median_s() / simulated_s * 1e6, one.error_omega);
    }
    pictures::draw({.charts = {{.y_label = "largest error of the wheel speed, of free rolling",
                                .x_label = "processor time per simulated millisecond (ns)",
                                .series = std::move(curves),
                                .logarithmic_x = true,
                                .logarithmic_y = true}}},
                   png);
}

settings::Json race(const std::vector<Case>& all, double output_s, int rounds, const std::filesystem::path& png) {
    std::vector<Candidate> them = candidates();
    double simulated_s = 0.0, reference_error = 0.0;
    for (const Case& c : all) {
        simulated_s += c.end_s;
        Trajectory truth;
        run_cvode(c, output_s, 1e-12, true, truth);
        for (Candidate& one : them) judge(one, c, output_s, truth);
        Candidate other{"", "", [](const Case& k, double h, Trajectory& out) { run_odeint(k, h, 1e-12, out); }};
        judge(other, c, output_s, truth);
        reference_error = std::max(reference_error, other.error_omega);
    }
    Trajectory out;
    out.reserve(200000);
    for (int round = 0; round < rounds; ++round) {
        for (Candidate& one : them) {
            one.seconds.push_back(bench::processor_s_of([&] {
                for (const Case& c : all) {
                    out.clear();
                    one.run(c, output_s, out);
                }
            }));
        }
    }
    fmt::print("{} runs, {:.0f} s simulated, speeds given out every {:g} ms, {} rounds; odeint at 1e-12 is within {:.0e} of the reference\n",
               all.size(), simulated_s, output_s * 1e3, rounds, reference_error);
    auto table = settings::TextTable::screen(":<26|:>17|ns per sim. ms:>16.1f|error v:>10.1e|error omega:>13.1e|odeint, at equal error:>25", "  ");
    settings::Json json{{"output_s", output_s},
                        {"runs", all.size()},
                        {"simulated_s", simulated_s},
                        {"rounds", rounds},
                        {"odeint_1e-12_from_reference", reference_error}};
    for (const Candidate& one : them) {
        const double ns_per_ms = one.median_s() / simulated_s * 1e6;
        const double ratio = seconds_for(them, kOdeint, one.error_omega) / one.median_s();
        const bool compared = one.method != kOdeint && std::isfinite(ratio);
        table.add(one.method, one.setting, ns_per_ms, one.error_v, one.error_omega, compared ? fmt::format("takes {:.2f} times", ratio) : "");
        json["integrators"].push_back({{"method", one.method},
                                       {"setting", one.setting},
                                       {"ns_per_simulated_ms", ns_per_ms},
                                       {"error_v", one.error_v},
                                       {"error_omega", one.error_omega},
                                       {"odeint_over_this_at_equal_error", compared ? settings::Json(ratio) : settings::Json()}});
    }
    fmt::print("{}", table.text());
    draw(them, simulated_s, png);
    return json;
}

int run(int argc, char** argv) {
    CLI::App app{
        "bench_plant: valve, brake, wheel and tyre, open loop on all 32 scenarios (ramp and hold, triangles, held\n"
        "steps): error over processor time of this plant with steps as long as the motion allows and with fixed\n"
        "ones, of boost::odeint's dopri5 (dense) and of CVODE (BDF, dense, integrals without error control) on the\n"
        "same equations, at several tolerances or steps each. Errors are the largest of all runs against CVODE at 1e-12,\n"
        "omega relative to free rolling.",
        "bench_plant"};
    int rounds = 3;
    double longest_s = 10.0;
    std::string json = "out/bench/plant.json";
    app.add_option("--rounds", rounds, "of all, in turns")->check(CLI::Range(1, 1000))->capture_default_str();
    app.add_option("--longest", longest_s, "of a run, simulated seconds")->check(CLI::Range(1.0, 200.0))->capture_default_str();
    app.add_option("--json", json, "where the figures go, the picture beside them")->capture_default_str();
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        return app.exit(e);
    }
    const auto png = std::filesystem::path(json).replace_extension(".png");
    settings::write_file(json, race(cases(longest_s), kOutput_s, rounds, png).dump(2) + "\n");
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::status_of("bench_plant", [&] { return run(argc, argv); });
}
