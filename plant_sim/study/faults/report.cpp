#include "plant_sim/study/faults/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "firmware/can/names.hpp"
#include "firmware/can/value_names.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"

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

nlohmann::ordered_json json_of(const Counts& counts) {
    nlohmann::ordered_json json;
    for (std::size_t i = 0; i < counts.size(); ++i) json[std::string(kOutcomeNames[i])] = counts[i];
    return json;
}

struct PairSummary {
    Counts outcomes{};
    std::map<std::string, std::size_t> named;
    double latest_name_s = 0.0;
};

}  // namespace

std::string to_csv(const FaultPlan& plan, std::span<const Row> rows) {
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

std::string to_json(const FaultPlan& plan, std::span<const Row> rows) {
    Counts all{};
    std::map<std::pair<Signal, Kind>, PairSummary> pairs;
    nlohmann::ordered_json unsafe = nlohmann::ordered_json::array();
    for (const auto& [run, result] : rows) {
        const Judgement& v = result.verdict;
        PairSummary& pair = pairs[{run.fault.what.signal, run.fault.what.kind}];
        ++all[static_cast<std::size_t>(v.outcome)];
        ++pair.outcomes[static_cast<std::size_t>(v.outcome)];
        for (const std::string& fault : antiskid::can::fault_names(v.named)) ++pair.named[fault];
        pair.latest_name_s = std::max(pair.latest_name_s, v.named_after_s);
        if (v.outcome == Outcome::unsafe) unsafe.push_back({{"run", run.number}, {"hazard", name(v.hazard)}});
    }
    nlohmann::ordered_json faults = nlohmann::ordered_json::array();
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
    const nlohmann::ordered_json json{
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
    return json.dump(2) + "\n";
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
    return text + fmt::format("; {:.3f} of the sound stop's distance, longest lock under pressure {:.3f} s", v.distance_share, v.longest_lock_s);
}

std::string to_table(const FaultPlan& plan, std::span<const Row> rows, std::size_t max) {
    std::map<Signal, Counts> signals;
    Counts all{};
    for (const Row& row : rows) {
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

void draw_matrix(const FaultPlan& plan, std::span<const Row> rows, const std::filesystem::path& png) {
    const std::size_t columns = kPhaseNames.size() * plan.surfaces.size();
    const std::span<const Pair> pairs = catalogue();
    constexpr int kNothing = -1;
    std::vector<int> worst(pairs.size() * columns, kNothing);
    for (const Row& row : rows) {
        const auto pair = static_cast<std::size_t>(std::find(pairs.begin(), pairs.end(), row.run.fault.what) - pairs.begin());
        const std::size_t column = static_cast<std::size_t>(row.run.phase) * plan.surfaces.size() + row.run.surface;
        int& cell = worst[pair * columns + column];
        cell = std::max(cell, static_cast<int>(row.result.verdict.outcome));
    }
    std::string cells;
    // Cells that were not run, too: gnuplot draws an image of a whole grid only.
    for (std::size_t i = 0; i < worst.size(); ++i)
        fmt::format_to(std::back_inserter(cells), "{} {} {}\n", i % columns, i / columns, worst[i] == kNothing ? "NaN" : std::to_string(worst[i]));
    std::string script = pictures::gnuplot_block("cells", cells) + "set ytics (";
    for (std::size_t i = 0; i < pairs.size(); ++i)
        fmt::format_to(std::back_inserter(script), "{}'{} {}' {}", i == 0 ? "" : ", ", name(pairs[i].signal), name(pairs[i].kind), i);
    script += ")\nset xtics (";
    const auto width = static_cast<double>(plan.surfaces.size());
    for (std::size_t i = 0; i < kPhaseNames.size(); ++i) {
        const double left = static_cast<double>(i) * width - 0.5;
        fmt::format_to(std::back_inserter(script), "{}'{}' {}", i == 0 ? "" : ", ", kPhaseNames[i], left + 0.5 * width);
    }
    script += ")\n";
    for (std::size_t i = 1; i < kPhaseNames.size(); ++i)
        fmt::format_to(std::back_inserter(script), "set arrow from {0}, graph 0 to {0}, graph 1 nohead front lc rgb '#ffffff' lw 2\n",
                       static_cast<double>(i) * width - 0.5);
    for (std::size_t i = 1; i < pairs.size(); ++i) {
        if (pairs[i].signal != pairs[i - 1].signal)
            fmt::format_to(std::back_inserter(script), "set arrow from graph 0, first {0} to graph 1, first {0} nohead front lc rgb '#ffffff' lw 2\n",
                           static_cast<double>(i) - 0.5);
    }
    std::string surfaces;
    for (const Surface& surface : plan.surfaces) surfaces += (surfaces.empty() ? "" : ", ") + surface.name;
    script += fmt::format(
        R"(unset grid
set xrange [-0.5:{}]
set yrange [{}:-0.5]
set tics scale 0 out nomirror font ',9'
set termoption noenhanced
set border lc rgb '#999999'
set palette defined (0 '#9cc9a4', 1 '#f0c75e', 2 '#6f9ec9', 3 '#c0262d') maxcolors 4
set cbrange [-0.5:3.5]
set cbtics ('handled' 0, 'degraded' 1, 'safe' 2, 'UNSAFE' 3)
set title {}
plot $cells using 1:2:3 with image notitle
)",
        static_cast<double>(columns) - 0.5, static_cast<double>(pairs.size()) - 0.5,
        pictures::gnuplot_quoted(
            fmt::format("{} runs, seed {}: the worst outcome of each cell; in each phase from left to right {}", rows.size(), plan.seed, surfaces)));
    constexpr int kWidth = 1150;
    constexpr int kHeight = 1900;
    pictures::run_gnuplot(png, kWidth, kHeight, script);
}

}  // namespace faults
