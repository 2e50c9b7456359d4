#include "plant_sim/study/faults/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "firmware/can/names.hpp"
#include "firmware/can/value_names.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "rig_bridge/pictures/map.hpp"

namespace faults {

namespace {

using antiskid::control::FaultSet;
using antiskid::control::kFaultCount;
using Counts = std::array<std::size_t, kOutcomeNames.size()>;

std::string text_of(FaultSet set) {
    return set.empty() ? "none" : fmt::format("{}", fmt::join(antiskid::can::fault_names(set), " "));
}

std::string duration(double lasts_s) {
    return lasts_s >= Fault::kForGood ? "for good" : fmt::format("for {:.3f} s", lasts_s);
}

settings::Json json_of(const Counts& counts) {
    settings::Json json;
    for (std::size_t i = 0; i < counts.size(); ++i) json[std::string(kOutcomeNames[i])] = counts[i];
    return json;
}

struct PairSummary {
    Counts outcomes{};
    std::map<std::string, std::size_t> named;
    double latest_name_s = 0.0;
};

}  // namespace

std::string to_csv(const FaultPlan& plan, std::span<const JudgedRun> rows) {
    auto csv = settings::TextTable::csv(
        "run|signal|kind|phase|surface|repetition|strength:.4f|share:.4f|negative|lasts_s:.4f|begun_s:.4f|begun_mps:.4f|outcome|hazard|named|named_"
        "after_s:.4f|distance_share:.4f|longest_lock_s:.4f|max_uncommanded_Pa:.0f");
    const auto number = [](double value, bool there) { return there ? std::optional(value) : std::nullopt; };
    for (const auto& [run, result] : rows) {
        const Judgement& v = result.verdict;
        const bool begun = result.begun_s >= 0.0;
        csv.add(run.number, name(run.fault.what.signal), name(run.fault.what.kind), name(run.phase), plan.surfaces[run.surface].name, run.repetition,
                run.fault.strength, run.fault.share, run.fault.negative ? 1 : 0, number(run.fault.lasts_s, run.fault.lasts_s < Fault::kForGood),
                number(result.begun_s, begun), number(result.begun_mps, begun), name(v.outcome), name(v.hazard), text_of(v.named),
                number(v.named_after_s, v.named_after_s >= 0.0), v.distance_share, v.longest_lock_s, v.max_uncommanded_Pa);
    }
    return csv.text();
}

std::string to_json(const FaultPlan& plan, std::span<const JudgedRun> rows) {
    Counts all{};
    std::map<std::pair<Signal, Kind>, PairSummary> pairs;
    settings::Json unsafe = settings::Json::array();
    for (const auto& [run, result] : rows) {
        const Judgement& v = result.verdict;
        PairSummary& pair = pairs[{run.fault.what.signal, run.fault.what.kind}];
        ++all[static_cast<std::size_t>(v.outcome)];
        ++pair.outcomes[static_cast<std::size_t>(v.outcome)];
        for (const std::string& fault : antiskid::can::fault_names(v.named)) ++pair.named[fault];
        pair.latest_name_s = std::max(pair.latest_name_s, v.named_after_s);
        if (v.outcome == Outcome::unsafe) unsafe.push_back({{"run", run.number}, {"hazard", name(v.hazard)}});
    }
    settings::Json faults = settings::Json::array();
    for (const Pair& what : catalogue()) {
        const auto found = pairs.find({what.signal, what.kind});
        if (found == pairs.end()) continue;
        faults.push_back({{"signal", name(what.signal)},
                          {"kind", name(what.kind)},
                          {"outcomes", json_of(found->second.outcomes)},
                          {"named", found->second.named},
                          {"latest_name_s", found->second.latest_name_s}});
    }
    std::vector<std::string> surfaces;
    for (const Surface& surface : plan.surfaces) surfaces.push_back(surface.name);
    const Bounds bounds;
    const settings::Json json{
        {"runs", rows.size()},
        {"outcomes", json_of(all)},
        {"unsafe", unsafe},
        {"bounds",
         {{"handled_share", bounds.handled_share},
          {"degraded_share", bounds.degraded_share},
          {"distance_slack_m", bounds.distance_slack_m},
          {"unasked_Pa", bounds.unasked_Pa},
          {"unasked_s", bounds.unasked_s},
          {"lock_slip", bounds.lock_slip},
          {"lock_pressure_Pa", bounds.lock_pressure_Pa},
          {"lock_above_mps", bounds.lock_above_mps},
          {"lock_s", bounds.lock_s},
          {"safe_within_periods", bounds.safe_within_periods},
          {"stop_within_s", bounds.stop_within_s}}},
        {"faults", faults},
        {"surfaces", surfaces},
        {"phases", kPhaseNames},
        {"repetitions", plan.repetitions},
        {"seed", plan.seed},
        {"version", plan.version},
        {"config_hash", plan.config_hash},
    };
    return settings::json_page(json);
}

std::string describe(const FaultPlan& plan, const Case& run) {
    return fmt::format("run {}: {} {}, strength {:.3f}, share {:.3f}{}, {}; {} on {}, repetition {}", run.number, name(run.fault.what.signal),
                       name(run.fault.what.kind), run.fault.strength, run.fault.share, run.fault.negative ? ", negative" : "",
                       duration(run.fault.lasts_s), name(run.phase), plan.surfaces[run.surface].name, run.repetition);
}

std::string describe(const Result& result) {
    const Judgement& v = result.verdict;
    std::string text{name(v.outcome)};
    if (v.hazard != Hazard::none) text += fmt::format(" ({})", name(v.hazard));
    if (result.begun_s < 0.0) return text + ": the stop ended before the fault began";
    text += fmt::format(": began at {:.3f} s and {:.1f} m/s; named {}", result.begun_s, result.begun_mps, text_of(v.named));
    if (v.named_after_s >= 0.0) text += fmt::format(" after {:.3f} s", v.named_after_s);
    return text + fmt::format("; {:.3f} of the fault-free stop's distance, longest lock under pressure {:.3f} s", v.distance_share, v.longest_lock_s);
}

std::string to_table(const FaultPlan& plan, std::span<const JudgedRun> rows, std::size_t max) {
    std::map<Signal, Counts> signals;
    Counts all{};
    for (const JudgedRun& row : rows) {
        const auto outcome = static_cast<std::size_t>(row.result.verdict.outcome);
        ++signals[row.run.fault.what.signal][outcome];
        ++all[outcome];
    }
    auto table = settings::TextTable::screen("signal:<18|handled:>9|degraded:>9|safe:>9|UNSAFE:>9", "  ");
    for (const auto& [signal, c] : signals) table.add(name(signal), c[0], c[1], c[2], c[3]);
    table.add("all", all[0], all[1], all[2], all[3]);
    std::string text = table.text();
    std::size_t shown = 0;
    for (const auto& [run, result] : rows) {
        if (result.verdict.outcome != Outcome::unsafe || shown++ >= max) continue;
        fmt::format_to(std::back_inserter(text), "  {}\n      {}\n", describe(plan, run), describe(result));
    }
    if (shown > max) fmt::format_to(std::back_inserter(text), "  and {} more\n", shown - max);
    return text;
}

void draw_matrix(const FaultPlan& plan, std::span<const JudgedRun> rows, const std::filesystem::path& png) {
    const std::size_t columns = kPhaseNames.size() * plan.surfaces.size();
    const std::span<const Pair> pairs = catalogue();
    const std::size_t surfaces = plan.surfaces.size();
    std::string in_each_phase;
    for (const Surface& surface : plan.surfaces) in_each_phase += (in_each_phase.empty() ? "" : ", ") + surface.name;
    pictures::Map map{.title = fmt::format("{} runs, seed {}; columns of each phase: {}", rows.size(), plan.seed, in_each_phase),
                      .columns = columns,
                      .values = std::vector(pairs.size() * columns, std::numeric_limits<double>::quiet_NaN()),
                      .x = {0.0, static_cast<double>(columns - 1)},
                      .y = {0.0, static_cast<double>(pairs.size() - 1)},
                      .classes = {kOutcomeNames.begin(), kOutcomeNames.end()}};
    for (const JudgedRun& row : rows) {
        const auto pair = static_cast<std::size_t>(std::find(pairs.begin(), pairs.end(), row.run.fault.what) - pairs.begin());
        double& cell = map.values[pair * columns + static_cast<std::size_t>(row.run.phase) * surfaces + row.run.surface];
        cell = std::fmax(cell, static_cast<double>(row.result.verdict.outcome));
    }
    for (std::size_t i = 0; i < kPhaseNames.size(); ++i) {
        const double left = static_cast<double>(i * surfaces) - 0.5;
        map.column_names.names.push_back({std::string(kPhaseNames[i]), left + 0.5 * static_cast<double>(surfaces)});
        if (i > 0) map.column_names.lines.push_back(left);
    }
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        map.row_names.names.push_back({fmt::format("{} {}", name(pairs[i].signal), name(pairs[i].kind)), static_cast<double>(i)});
        if (i > 0 && pairs[i].signal != pairs[i - 1].signal) map.row_names.lines.push_back(static_cast<double>(i) - 0.5);
    }
    constexpr int kHeight = 1900;
    pictures::draw(map, kHeight, png);
}

}  // namespace faults
