#include "plant_sim/study/margins/law_judge.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>

#include "plant_sim/study/margins/law_loop.hpp"

namespace study::margins {

namespace {

using antiskid::control::Config;
using antiskid::control::SlipConfig;

constexpr double kUnstable = 1e-9;        // smallest growth of an unstable loop
constexpr double kNoStops = -2.0;         // below every score by margins
constexpr std::size_t kBeforeStops = 16;  // number of cells that are tested before the stops: they are cheaper and reject most gains

struct Gain {
    const char* key;
    float SlipConfig::*in;
};
// One table for names and members, so that they cannot differ.
constexpr std::array<Gain, 8> kGains{{
    {"k_p_per_s", &SlipConfig::k_p_per_s},
    {"k_i_per_s2", &SlipConfig::k_i_per_s2},
    {"k_d", &SlipConfig::k_d},
    {"k_dd_s", &SlipConfig::k_dd_s},
    {"k_pole", &SlipConfig::k_pole},
    {"low_speed_mps", &SlipConfig::low_speed_mps},
    {"low_speed_floor_mps", &SlipConfig::low_speed_floor_mps},
    {"low_speed_slip", &SlipConfig::low_speed_slip},
}};

}  // namespace

LawJudge::LawJudge(const std::vector<StopConditions>& scenarios, const TrialStops& trial, const StudyOptions& options)
    : scenarios_(scenarios), trial_(trial), options_(options) {
    for (std::size_t i = 0; i < scenarios.size(); ++i)
        for (const double v : speed_grid(scenarios[i].rig.brake_on_mps, scenarios[i].drop_out_mps, options.speeds)) places_.push_back({i, v});
    if (places_.empty() || trial.stops.empty()) throw std::invalid_argument("gains cannot be judged without scenarios and stops");
    ended_ = std::vector<std::atomic<unsigned>>(places_.size());
}

double LawJudge::cell(const Config& controller, const Place& place) const {
    const StopConditions& s = scenarios_[place.scenario];
    const OperatingPoint at = options_.equilibrium(s.rig, controller.slip, place.speed_mps);
    const PeriodicSystem system = law_system(controller, s.rig, at, Linearisation::full);
    const SampledLoop loop(system);
    const double growth_per_s = std::max(loop.closed_poles().front().real(), controller_growth_per_s(system) - kIntegrates_per_s);
    if (growth_per_s >= 0.0) return -growth_per_s / (1.0 + growth_per_s) - kUnstable;
    return margins::score(margins(loop, kCoarseWalk), options_.requirement);
}

std::vector<std::size_t> LawJudge::hardest_first() const {
    std::vector<std::pair<unsigned, std::size_t>> order;
    order.reserve(places_.size());
    for (std::size_t i = 0; i < places_.size(); ++i) order.emplace_back(std::numeric_limits<unsigned>::max() - ended_[i].load(), i);
    std::sort(order.begin(), order.end());
    std::vector<std::size_t> indices;
    indices.reserve(order.size());
    for (const auto& o : order) indices.push_back(o.second);
    return indices;
}

double LawJudge::score(const Config& controller, double to_beat) const {
    const std::vector<std::size_t> order = hardest_first();
    double worst = std::numeric_limits<double>::infinity();
    const auto ends = [&](std::size_t i) {
        worst = std::min(worst, cell(controller, places_[i]));
        if (worst >= to_beat) return false;
        ++ended_[i];
        return true;
    };
    const std::size_t before = to_beat >= kNoStops ? std::min(kBeforeStops, order.size()) : 0;
    for (std::size_t i = 0; i < before; ++i)
        if (ends(order[i])) return worst;
    const StopsShown stops = make_stops(trial_, controller, std::max(0.0, kNoStops - to_beat));
    if (stops.violation > 0.0) return kNoStops - stops.violation;
    for (std::size_t i = before; i < order.size(); ++i)
        if (ends(order[i])) return worst;
    return worst;
}

WorstScore LawJudge::margins_of(const Config& controller) const {
    WorstScore w;
    double min = std::numeric_limits<double>::infinity();
    for (const Place& place : places_) {
        const double s = cell(controller, place);
        ++w.counted;
        if (s < 0.0) ++w.unstable;
        if (s >= 1.0) ++w.met;
        min = std::min(min, s);
    }
    w.value = min;
    return w;
}

Config with_gains(Config config, const std::vector<double>& values) {
    for (std::size_t i = 0; i < kGains.size(); ++i) config.slip.*kGains[i].in = static_cast<float>(values.at(i));
    return config;
}

std::vector<double> gains_of(const Config& config) {
    std::vector<double> values;
    values.reserve(kGains.size());
    for (const Gain& g : kGains) values.push_back(static_cast<double>(config.slip.*g.in));
    return values;
}

std::vector<std::string> gain_names() {
    std::vector<std::string> names;
    names.reserve(kGains.size());
    for (const Gain& g : kGains) names.emplace_back(g.key);
    return names;
}

}  // namespace study::margins
