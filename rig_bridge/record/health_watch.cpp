#include "rig_bridge/record/health_watch.hpp"

#include <fmt/format.h>

#include "rig_bridge/wear/health.hpp"
#include "rig_bridge/wear/population_io.hpp"

namespace rig::record {

namespace {

HealthState state_of(wear::Condition condition) {
    switch (condition) {
        case wear::Condition::unknown:
            return HealthState::unknown;
        case wear::Condition::healthy:
            return HealthState::healthy;
        case wear::Condition::suspect:
            return HealthState::suspect;
        case wear::Condition::abnormal:
            return HealthState::abnormal;
    }
    return HealthState::unknown;
}

}  // namespace

struct HealthWatch::Impl {
    explicit Impl(const std::filesystem::path& path) : file(wear::read_population(path)), monitor(file.population) {}

    wear::PopulationFile file;
    wear::HealthMonitor monitor;
};

HealthWatch::HealthWatch(const std::filesystem::path& model) : impl_(std::make_unique<Impl>(model)) {}
HealthWatch::~HealthWatch() = default;

std::string HealthWatch::learnt_from() const {
    return impl_->file.population.provenance.sentence();
}

Health HealthWatch::after(const Summary& summary) {
    if (summary.outcome != "finished" || off_conditions(summary)) return newest_;
    const wear::Verdict v = impl_->monitor.after({summary.cumulative_energy_J, summary.figures.mean_friction});
    newest_.state = state_of(v.condition);
    if (newest_.state != HealthState::unknown) newest_.statistic = v.statistic;
    newest_.reason = v.reason;
    if (!v.reason.empty()) newest_.reason += fmt::format("; judged by brakes {}", learnt_from());
    newest_.model = impl_->file.hash;
    return newest_;
}

void catch_up(HealthWatch& watch, Ledger& ledger, const std::vector<LedgerRow>& rows) {
    for (const LedgerRow& row : rows) {
        if (row.state != RowState::finished || off_conditions(row.summary)) continue;
        const Health health = watch.after(row.summary);
        if (row.health.model.empty()) ledger.judge(row.summary.number, health);
    }
}

}  // namespace rig::record
