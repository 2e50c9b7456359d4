#include "plant_sim/endurance/endurance_campaign.hpp"

#include <fmt/core.h>

#include <array>
#include <chrono>
#include <optional>

#include "firmware/host/settings/hash.hpp"
#include "plant_sim/endurance/test_cell.hpp"
#include "plant_sim/wear/brake_state.hpp"
#include "rig_bridge/record/health_watch.hpp"
#include "rig_bridge/rig/acceptance.hpp"

namespace endurance {

namespace {

/// ISO 8601, days of any year.
std::string rig_clock(double seconds) {
    namespace chrono = std::chrono;
    const chrono::sys_seconds t{chrono::seconds(static_cast<std::int64_t>(seconds))};
    const auto day = chrono::floor<chrono::days>(t);
    const chrono::year_month_day date{day};
    const chrono::hh_mm_ss time{t - day};
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                       static_cast<unsigned>(date.day()), time.hours().count(), time.minutes().count(), time.seconds().count());
}

/// Files and options that must be unchanged when a campaign continues.
std::string configuration(const EnduranceSetup& setup, const CampaignOptions& o) {
    if (!o.by_model && o.taken_J == 0.0) return setup.config_hash;
    std::string brake = fmt::format("{}", o.taken_J);
    if (o.by_model) brake += fmt::format(" {} {}", static_cast<int>(o.by_model->variance), static_cast<int>(o.by_model->choice));
    const std::array<std::string_view, 2> parts{setup.config_hash, brake};
    return settings::hash_bytes(parts);
}

/// The brake before the next maneuver. Its energy is that of the ledger; the state file may be one maneuver behind if the program was killed between
/// the two.
wear::BrakeState brake_before(const CampaignOptions& o, const wear::BrakeWear& wear, const rig::record::Ledger& ledger, const std::string& campaign) {
    std::optional<wear::BrakeState> kept;
    if (!o.brake_state.empty()) kept = wear::find_brake_state(o.brake_state, wear);
    std::vector<double> energies_J;
    for (const rig::record::LedgerRow& row : rig::record::read_ledger(o.ledger, campaign)) {
        if (row.state == rig::record::RowState::finished || row.state == rig::record::RowState::aborted)
            energies_J.push_back(row.summary.cumulative_energy_J);
    }
    if (energies_J.empty()) return kept.value_or(wear::BrakeState{o.seed, 0, o.taken_J});
    const double now_J = ledger.cumulative_energy_J();
    if (!kept) return {o.seed, energies_J.size(), now_J};
    if (kept->c_e_J == now_J) return *kept;
    if (energies_J.size() > 1 && kept->c_e_J == energies_J[energies_J.size() - 2]) return {kept->seed, kept->maneuvers + 1, now_J};
    throw settings::Error(
        o.brake_state.string(), 0, "cumulative_energy_J",
        fmt::format("{} J is not where the campaign in {} stands ({} J); the brake has been used elsewhere since, or never was this one", kept->c_e_J,
                    o.ledger.string(), now_J));
}

rig::record::Summary head(const EnduranceSetup& setup, const CampaignOptions& options) {
    rig::record::Summary summary;
    summary.campaign = setup.scenario.name;
    summary.scenario = setup.scenario.name;
    summary.seed = options.seed;
    summary.version = ANTISKID_VERSION;
    summary.config_hash = configuration(setup, options);
    return summary;
}

}  // namespace

CampaignResult run_campaign(const EnduranceSetup& setup, const CampaignOptions& options, const CampaignObserver& observe) {
    rig::record::Ledger ledger(options.ledger, {.durable = false});
    rig::record::Summary next = head(setup, options);
    ledger.open_campaign({.name = next.campaign,
                          .scenario = next.scenario,
                          .seed = options.seed,
                          .planned = options.maneuvers,
                          .config_hash = next.config_hash,
                          .version = next.version,
                          .created = rig_clock(0.0)},
                         rig::record::IfChanged::reject);
    CampaignResult result;
    result.earlier = ledger.finished_count();
    plc::ServedRigOptions machinery = setup.machinery;
    wear::BrakeWear wear = setup.scenario.rig.wear;
    if (options.by_model) wear.law.reset();
    const wear::ConditionalRule rule = options.by_model.value_or(wear::ConditionalRule{});
    wear::BrakeState brake = brake_before(options, wear, ledger, next.campaign);
    next.cumulative_energy_J = brake.c_e_J;
    machinery.brake.emplace(wear, rule, brake);
    TestCell cell(setup.scenario, setup.controller, setup.layout, machinery, options.seed);
    std::optional<rig::record::HealthWatch> watch;
    if (!options.wear_model.empty()) {
        watch.emplace(options.wear_model);
        result.model_origin = watch->learnt_from();
        rig::record::catch_up(*watch, ledger, rig::record::read_ledger(options.ledger, next.campaign));
    }
    const rig::Plan& mean = setup.scenario.mean;
    std::optional<double> slip_reference;  // only for the slip law
    if (mean.law == rig::BrakeLaw::slip) slip_reference = mean.slip_reference;
    while (const auto number = ledger.next_number()) {
        if (options.stop != nullptr && options.stop->load()) break;
        next.number = *number;
        next.started = rig_clock(cell.time_s());
        (void)ledger.begin(*number, next.started, slip_reference);
        cell.rig().set_brake_state(brake);
        const rig::Plan plan = rig::plan(setup.scenario, options.seed, *number);
        result.last = summary_of(next, cell.run(plan), rig::acceptance(setup.scenario, plan));
        ledger.finish(result.last);
        if (watch && result.last.outcome == "finished" && !rig::record::off_conditions(result.last)) ledger.judge(*number, watch->after(result.last));
        next.cumulative_energy_J = result.last.cumulative_energy_J;
        brake = {brake.seed, brake.maneuvers + 1, next.cumulative_energy_J};
        if (!options.brake_state.empty()) wear::write_brake_state(options.brake_state, brake, wear);
        if (observe) observe(result.last, options.maneuvers);
        result.aborted = result.last.outcome != "finished";
        if (result.aborted) break;
    }
    if (watch) result.health = watch->newest();
    for (rig::record::LedgerRow& row : rig::record::read_ledger(options.ledger, next.campaign)) {
        if (row.state == rig::record::RowState::finished) result.finished.push_back(std::move(row.summary));
    }
    result.brake.emplace(wear, rule, brake);
    return result;
}

}  // namespace endurance
