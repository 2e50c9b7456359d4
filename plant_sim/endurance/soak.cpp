#include "plant_sim/endurance/soak.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "firmware/can/names.hpp"
#include "firmware/can/value_names.hpp"
#include "firmware/host/settings/json.hpp"
#include "plant_sim/endurance/test_cell.hpp"

namespace endurance {

namespace {

/// Running mean and standard deviation (Welford).
class Running {
  public:
    void add(double x) {
        ++count_;
        const double off = x - mean_;
        mean_ += off / static_cast<double>(count_);
        squares_ += off * (x - mean_);
    }
    [[nodiscard]] std::int64_t count() const { return count_; }
    [[nodiscard]] double mean() const { return mean_; }
    [[nodiscard]] double deviation() const { return count_ > 1 ? std::sqrt(squares_ / static_cast<double>(count_ - 1)) : 0.0; }

  private:
    std::int64_t count_ = 0;
    double mean_ = 0.0;
    double squares_ = 0.0;
};

std::string wrong_with(const Outcome& outcome) {
    if (outcome.phase != rig::Phase::finished) return fmt::format("aborted: {}", rig::name(outcome.abort));
    if (!outcome.faults.empty()) return "fault " + antiskid::can::fault_names(outcome.faults).front();
    return {};
}

struct Third {
    double mean_m = 0.0;
    double variance_of_mean_m2 = 0.0;
};

/// Mean of four spans.
Third third(const SoakResult& result, std::size_t first) {
    double landings = 0.0;
    double sum_m = 0.0;
    double squares_m2 = 0.0;
    for (std::size_t i = first; i < first + SoakResult::kSpans / 3; ++i) {
        const SoakSpan& span = result.spans[i];
        const auto n = static_cast<double>(span.landings);
        landings += n;
        sum_m += n * span.length_m_mean;
        squares_m2 += n * span.length_m_deviation * span.length_m_deviation;
    }
    if (landings == 0.0) return {};
    return {sum_m / landings, squares_m2 / landings / landings};
}

}  // namespace

SoakResult soak(const EnduranceSetup& setup, const SoakOptions& options, const std::function<std::size_t()>& heap_bytes,
                const std::function<void(double)>& observe) {
    SoakResult result;
    std::array<Running, SoakResult::kSpans> lengths_m;
    plc::ServedRigOptions machinery = setup.machinery;
    const wear::BrakeState as_new{options.seed, 0, 0.0};
    machinery.brake.emplace(setup.scenario.rig.wear, wear::ConditionalRule{}, as_new);
    TestCell cell(setup.scenario, setup.controller, setup.layout, machinery, options.seed);
    while (result.seconds < options.seconds && result.ended_by.empty()) {
        if (options.stop != nullptr && options.stop->load()) break;
        const auto span = static_cast<std::size_t>(static_cast<double>(SoakResult::kSpans) * result.seconds / options.seconds);
        cell.rig().set_brake_state({options.seed, static_cast<std::uint64_t>(result.landings), 0.0});
        const Outcome outcome = cell.run(rig::plan(setup.scenario, options.seed, result.landings + 1));
        result.ended_by = wrong_with(outcome);
        result.seconds = std::chrono::duration<double>(cell.controller_time()).count();
        ++result.landings;
        lengths_m[span].add(outcome.figures.length_m);
        std::size_t& max = result.spans[span].max_heap_bytes;
        max = std::max(max, heap_bytes());
        if (observe) observe(std::min(result.seconds / options.seconds, 1.0));
    }
    for (std::size_t i = 0; i < SoakResult::kSpans; ++i) {
        result.spans[i].landings = lengths_m[i].count();
        result.spans[i].length_m_mean = lengths_m[i].mean();
        result.spans[i].length_m_deviation = lengths_m[i].deviation();
    }
    return result;
}

std::vector<std::string> violations(const SoakResult& result) {
    std::vector<std::string> list;
    if (!result.ended_by.empty()) list.push_back(fmt::format("landing {}: {}", result.landings, result.ended_by));
    for (std::size_t i = 2; i < SoakResult::kSpans; ++i) {
        if (result.spans[i].max_heap_bytes > result.spans[1].max_heap_bytes)
            list.push_back(fmt::format("{} bytes of heap in use in span {}, {} in span 2", result.spans[i].max_heap_bytes, i + 1,
                                       result.spans[1].max_heap_bytes));
    }
    const Third first = third(result, 0);
    const Third last = third(result, SoakResult::kSpans - SoakResult::kSpans / 3);
    const double error_m = std::sqrt(first.variance_of_mean_m2 + last.variance_of_mean_m2);
    if (last.mean_m > 0.0 && std::abs(last.mean_m - first.mean_m) > 4.0 * error_m)
        list.push_back(fmt::format("mean length {:.3f} m in the first third, {:.3f} m in the last, standard error {:.3f} m", first.mean_m,
                                   last.mean_m, error_m));
    return list;
}

std::string to_json(const SoakResult& result, const EnduranceSetup& setup, std::uint64_t seed) {
    settings::Json json{{"scenario", setup.scenario.name}, {"config_hash", setup.config_hash}, {"version", ANTISKID_VERSION},     {"seed", seed},
                        {"seconds", result.seconds},       {"landings", result.landings},      {"complaints", violations(result)}};
    for (const SoakSpan& span : result.spans) {
        json["spans"].push_back({{"landings", span.landings},
                                 {"length_m_mean", span.length_m_mean},
                                 {"length_m_deviation", span.length_m_deviation},
                                 {"max_heap_bytes", span.max_heap_bytes}});
    }
    return settings::json_page(json);
}

}  // namespace endurance
