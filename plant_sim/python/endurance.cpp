#include "plant_sim/python/endurance.hpp"

#include <fmt/format.h>

#include <atomic>
#include <memory>
#include <optional>
#include <stdexcept>

#include "firmware/host/settings/atomic_file.hpp"
#include "plant_sim/endurance/endurance_campaign.hpp"
#include "plant_sim/endurance/table_three.hpp"
#include "plant_sim/python/arrays.hpp"
#include "plant_sim/python/interruptible.hpp"
#include "plant_sim/study/torque_replay.hpp"
#include "rig_bridge/replay/campaign_source.hpp"
#include "rig_bridge/wear/model_io.hpp"

namespace plant_sim::python {

std::string endurance_table(const EnduranceRequest& request) {
    if (request.maneuvers < 1) throw std::invalid_argument("maneuvers: expected 1 or more");
    if (request.seed > INT64_MAX) throw std::invalid_argument("seed: expected less than 2^63, as a ledger can hold it");
    std::atomic<bool> stop{false};
    const auto campaign = [&] {
        const std::filesystem::path& config = request.config;
        const endurance::EnduranceSetup setup =
            endurance::load_setup(request.scenario.empty() ? config / "scenarios" / "endurance.toml" : request.scenario, config);
        settings::create_directories(request.out);
        const endurance::CampaignResult result = endurance::run_campaign(
            setup, {.maneuvers = request.maneuvers, .seed = request.seed, .ledger = request.out / "campaign.sqlite", .stop = &stop});
        if (result.aborted) throw std::runtime_error(fmt::format("maneuver {} was aborted: {}", result.last.number, result.last.outcome));
        const auto printed = setup.scenario.endurance() ? std::optional(endurance::printed_table(config)) : std::nullopt;
        return endurance::to_json(
            {.scenario = setup.scenario.name, .config_hash = setup.config_hash, .version = ANTISKID_VERSION, .seed = request.seed}, result.finished,
            printed);
    };
    return interruptible(campaign, [&] { stop = true; });
}

pybind11::tuple replayed_wear(const ReplayRequest& request) {
    std::atomic<bool> stop{false};
    const auto replay = [&] {
        const wear::Campaign recorded = rig::replay::load_campaign(request.ledger, request.campaign);
        rig::ManeuverChoice choice;
        choice.maneuver = rig::kEndurance;
        wear::BrakeWear brake;
        brake.model = std::make_shared<const wear::Model>(wear::from_json("model", request.model));
        brake.life_J = brake.model->data.last_c_e_J;
        // The seed as the verb takes it: draws that a campaign of the same seed did not make.
        const wear::BrakeState state{.seed = ~request.seed, .maneuvers = 0, .c_e_J = wear::taken_before_J(recorded)};
        return study::replay_torques(recorded, rig::load_rig(request.config, choice), {brake, {}, state}, [&](std::size_t) {
            if (stop) throw std::runtime_error("stopped");
        });
    };
    const study::TorqueReplay replayed = interruptible(replay, [&] { stop = true; });
    return pybind11::make_tuple(column(replayed.simulated.points, [](const wear::Point& p) { return p.c_e_J; }),
                                column(replayed.simulated.points, [](const wear::Point& p) { return p.mean_friction; }));
}

}  // namespace plant_sim::python
