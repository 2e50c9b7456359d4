#include <fmt/format.h>

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

#include "firmware/host/settings/atomic_file.hpp"
#include "plant_sim/endurance/endurance_campaign.hpp"
#include "plant_sim/endurance/table_three.hpp"
#include "plant_sim/python/bindings.hpp"
#include "plant_sim/python/interruptible.hpp"

namespace plant_sim::python {

namespace {

struct EnduranceRequest {
    std::filesystem::path out, scenario, config;  ///< scenario empty: that of `config`
    std::int64_t maneuvers = 500;
    std::uint64_t seed = 1;
};

/// As `rig-lab endurance`: writes campaign.sqlite in `out`, or continues it. Returns the text of its table.json. Throws std::runtime_error for an
/// aborted maneuver. The caller must hold Python's lock, which is released during the run.
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

}  // namespace

void bind_endurance(py::module_& m) {
    const EnduranceRequest campaign;
    m.def(
        "endurance",
        [](const std::filesystem::path& out, std::int64_t maneuvers, std::uint64_t seed, const Directory& scenario, const Directory& config) {
            return endurance_table({.out = out,
                                    .scenario = scenario.value_or(std::filesystem::path()),
                                    .config = directory_of(config),
                                    .maneuvers = maneuvers,
                                    .seed = seed});
        },
        py::arg("out"), py::kw_only(), py::arg("maneuvers") = campaign.maneuvers, py::arg("seed") = campaign.seed, py::arg("scenario") = py::none(),
        py::arg("config") = py::none());
}

}  // namespace plant_sim::python
