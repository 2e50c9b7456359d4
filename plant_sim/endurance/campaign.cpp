#include "plant_sim/endurance/campaign.hpp"

#include <fmt/core.h>

#include <array>
#include <chrono>

#include "firmware/can/value_names.hpp"
#include "plant_sim/endurance/test_cell.hpp"

namespace endurance {

namespace {

/// ISO 8601, days of any year.
std::string rig_clock(double seconds) {
    namespace chrono = std::chrono;
    const chrono::sys_seconds t{chrono::seconds(static_cast<std::int64_t>(seconds))};
    const auto day = chrono::floor<chrono::days>(t);
    const chrono::year_month_day date{day};
    const chrono::hh_mm_ss time{t - day};
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", static_cast<int>(date.year()),
                       static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                       time.hours().count(), time.minutes().count(), time.seconds().count());
}

std::vector<std::string> names(antiskid::control::FaultSet faults) {
    std::vector<std::string> list;
    for (std::size_t i = 0; i < antiskid::can::kFaultNames.size(); ++i) {
        if (faults.contains(static_cast<antiskid::control::Fault>(i)))
            list.emplace_back(antiskid::can::kFaultNames[i]);
    }
    return list;
}

rig::Summary head(const Setup& setup, const CampaignOptions& options) {
    rig::Summary summary;
    summary.campaign = setup.scenario.name;
    summary.scenario = setup.scenario.name;
    summary.seed = options.seed;
    summary.version = ANTISKID_VERSION;
    summary.config_hash = setup.config_hash;
    return summary;
}

rig::Summary summary_of(const rig::Summary& head, const Outcome& outcome) {
    rig::Summary summary = head;
    const bool finished = outcome.phase == sequencer::Phase::finished;
    summary.outcome = finished ? "finished" : sequencer::name(outcome.abort);
    summary.figures = outcome.figures;
    summary.cumulative_energy_J += outcome.figures.energy_brake_J;
    summary.faults = names(outcome.faults);
    return summary;
}

}  // namespace

CampaignResult run_campaign(const Setup& setup, const CampaignOptions& options,
                            const CampaignObserver& observe) {
    rig::Ledger ledger(options.ledger, {.durable = false});
    rig::Summary next = head(setup, options);
    ledger.open_campaign({.name = next.campaign,
                          .scenario = next.scenario,
                          .seed = options.seed,
                          .planned = options.maneuvers,
                          .config_hash = setup.config_hash,
                          .version = next.version,
                          .created = rig_clock(0.0)},
                         rig::IfChanged::refuse);
    CampaignResult result;
    result.already = ledger.finished_count();
    plc::ServedRigOptions machinery = setup.machinery;
    machinery.taken_J = next.cumulative_energy_J = ledger.cumulative_energy_J();
    TestCell cell(setup.scenario, setup.controller, setup.layout, machinery, options.seed);
    while (const auto number = ledger.next_number()) {
        if (options.stop != nullptr && options.stop->load()) break;
        next.number = *number;
        next.started = rig_clock(cell.time_s());
        (void)ledger.begin(*number, next.started);
        result.last = summary_of(next, cell.run(rig::plan(setup.scenario, options.seed, *number)));
        ledger.finish(result.last);
        next.cumulative_energy_J = result.last.cumulative_energy_J;
        if (observe) observe(result.last, options.maneuvers);
        result.aborted = result.last.outcome != "finished";
        if (result.aborted) break;
    }
    for (rig::LedgerRow& row : rig::read_ledger(options.ledger, next.campaign)) {
        if (row.state == rig::RowState::finished) result.finished.push_back(std::move(row.summary));
    }
    return result;
}

}  // namespace endurance
