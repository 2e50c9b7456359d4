#include "plant_sim/simulation/ledger_judge.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>

#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "rig_bridge/replay/log_meter.hpp"

namespace plant_sim::simulation {

using antiskid::control::Time;
using rig::record::LedgerRow;
using rig::record::RowState;

namespace {

constexpr Time kStep{100'000'000};
// The age of a reading of the load cells is known to half a scan of the PLC, 1.3 % of a stop of one second; if the PLC falls silent during it, the
// speeds say what the brake took.
constexpr double kFinishedOff = 0.05;
constexpr double kElseOff = 0.1;
constexpr Time kUnwritten{1'300'000'000};  // files are synced each second, written each 0.1 s

/// "... may have taken up to 0.481 MJ that are in no record".
double named_J(const std::vector<std::string>& warnings) {
    double sum_J = 0.0;
    for (const std::string& warning : warnings) {
        const auto at = warning.find("up to ");
        double MJ = 0.0;
        if (at != std::string::npos && std::sscanf(warning.c_str() + at, "up to %lg MJ", &MJ) == 1) sum_J += 1e6 * MJ;
    }
    return sum_J;
}

bool warned(const std::vector<std::string>& warnings, std::string_view of) {
    return std::any_of(warnings.begin(), warnings.end(), [of](const std::string& warning) { return warning.starts_with(of); });
}

}  // namespace

void EnergyAccount::advance(Time now, double taken_J) {
    taken_J_ = taken_J;
    if (!lately_.empty() && now - lately_.back().at < kStep) return;
    lately_.push_back({.at = now, .taken_J = taken_J});
    while (now - lately_.front().at > kUnwritten + kStep) lately_.pop_front();
}

void EnergyAccount::bridge_ended() {
    if (!attempts_.empty() && !lately_.empty()) attempts_.back().sure_J = lately_.front().taken_J;
}

std::vector<std::string> EnergyAccount::check(std::span<const LedgerRow> rows) const {
    std::vector<std::string> wrong;
    for (const LedgerRow& row : rows)
        if (row.counted_J != 0.0 &&
            std::none_of(attempts_.begin(), attempts_.end(), [&](const Attempt& one) { return one.folder == row.attempt.folder; }))
            wrong.push_back(
                fmt::format("maneuver {}, attempt {}: {:.0f} J, and it was not run", row.attempt.number, row.attempt.attempt, row.counted_J));
    for (std::size_t i = 0; i < attempts_.size(); ++i) {
        const Attempt& attempt = attempts_[i];
        const auto row = std::find_if(rows.begin(), rows.end(), [&](const LedgerRow& one) { return one.attempt.folder == attempt.folder; });
        if (row == rows.end() || row->state == RowState::running) continue;
        const double taken_J = (i + 1 < attempts_.size() ? attempts_[i + 1].before_J : taken_J_) - attempt.before_J;
        const double sure_J = attempt.sure_J ? *attempt.sure_J - attempt.before_J : taken_J;
        const double unknown_J = named_J(row->summary.warnings);
        // Energy that a bridge could not know is reported, so that a person can amend it.
        if (warned(row->summary.warnings, rig::record::kEnergyUnbalanced)) continue;
        const double off_J = row->state == RowState::finished ? kFinishedOff * taken_J : kElseOff * landing_J_;
        const bool damaged = warned(row->summary.warnings, "log_damaged");
        if (row->counted_J > taken_J + off_J || (!damaged && row->counted_J + unknown_J < sure_J - off_J))
            wrong.push_back(
                fmt::format("maneuver {}, attempt {}: the ledger has {:.0f} J of it, {:.0f} J are named as unknown, and the brake took {:.0f} J; {}",
                            row->attempt.number, row->attempt.attempt, row->counted_J, unknown_J, taken_J,
                            row->summary.warnings.empty() ? "no warnings" : fmt::format("warnings {}", fmt::join(row->summary.warnings, "; "))));
    }
    return wrong;
}

std::vector<std::string> RecomputedFigures::check(std::span<const rig::record::LedgerRow> rows) {
    std::vector<std::string> wrong;
    for (const rig::record::LedgerRow& row : rows) {
        if (row.state != rig::record::RowState::finished || !seen_.insert(row.attempt.folder).second) continue;
        const rig::replay::LogText log{disk_->bytes(row.attempt.folder / "bus.log")};
        rig::replay::LogWarnings warnings("bus.log", {});
        const rig::replay::MeteredLog made = rig::replay::meter_log(log, setup_.layout, setup_.meter, warnings);
        const rig::record::Summary written = rig::record::read_summary(row.attempt.folder / "summary.json", *disk_);
        const std::string what = fmt::format("maneuver {}, attempt {}", row.attempt.number, row.attempt.attempt);
        for (const rig::record::FigureField& field : rig::record::kFigureFields)
            for (const auto& [where, figures] : {std::pair{"summary.json", &written.figures}, std::pair{"the ledger", &row.summary.figures}})
                if (figures->*field.value != made.figures.*field.value)
                    wrong.push_back(fmt::format("{}: {} has {} = {}, its recording says {}", what, where, field.key, figures->*field.value,
                                                made.figures.*field.value));
        if (written.warnings != made.warnings)
            wrong.push_back(fmt::format("{}: summary.json warns of '{}', its recording of '{}'", what, fmt::join(written.warnings, "; "),
                                        fmt::join(made.warnings, "; ")));
    }
    return wrong;
}

}  // namespace plant_sim::simulation
