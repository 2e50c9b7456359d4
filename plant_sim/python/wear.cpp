#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "plant_sim/python/bindings.hpp"
#include "plant_sim/python/interruptible.hpp"
#include "plant_sim/wear/forecast_request.hpp"
#include "rig_bridge/wear/fit.hpp"
#include "rig_bridge/wear/model_io.hpp"
#include "rig_bridge/wear/on_threads.hpp"
#include "rig_bridge/wear/population_io.hpp"
#include "rig_bridge/wear/wear_campaign.hpp"

namespace plant_sim::python {

namespace {

/// Maneuvers of a brake, in their order.
struct WearPoints {
    std::vector<double> energy_J;  ///< c_e
    std::vector<double> friction;
    std::string source;                         ///< for people
    std::string origin{};                       ///< see provenance.hpp; empty: unknown
    std::vector<wear::LiningReading> lining{};  ///< in their order
};

wear::Campaign campaign_of(const WearPoints& points) {
    if (points.energy_J.size() != points.friction.size())
        throw std::invalid_argument(
            fmt::format("{} energies and {} frictions: expected one of each a maneuver", points.energy_J.size(), points.friction.size()));
    if (!points.origin.empty() && !wear::is_origin(points.origin))
        throw std::invalid_argument("origin: '" + points.origin + "' does not begin with 'measured' or 'made up'");
    wear::Campaign campaign;
    campaign.source = points.source;
    if (!points.origin.empty()) campaign.origin = points.origin;
    for (std::size_t i = 0; i < points.energy_J.size(); ++i) campaign.points.push_back({points.energy_J[i], points.friction[i]});
    campaign.readings = points.lining;
    wear::check(campaign);
    return campaign;
}

py::object loaded(const std::string& json) {
    return py::module_::import("json").attr("loads")(json);
}

std::vector<wear::LiningReading> readings_of(const std::vector<double>& energy_J, const std::vector<double>& worn) {
    if (energy_J.size() != worn.size())
        throw std::invalid_argument(
            fmt::format("lining: {} energies and {} worn shares: expected one of each a reading", energy_J.size(), worn.size()));
    std::vector<wear::LiningReading> readings;
    readings.reserve(worn.size());
    for (std::size_t i = 0; i < worn.size(); ++i) readings.push_back({energy_J[i], worn[i]});
    return readings;
}

/// Contents of the model.json of `rig-lab wear fit`. `threads`: 0: all cores.
py::object fit_wear(const WearPoints& points, const wear::FitSettings& settings, unsigned threads) {
    const wear::Campaign campaign = campaign_of(points);
    std::stop_source stop;
    const auto fit = [&] {
        return wear::fit(campaign, settings, {.threads = threads > 0 ? threads : wear::all_cores(), .stop = stop.get_token(), .progress = {}});
    };
    return loaded(wear::to_json(wear::model_of(campaign, interruptible(fit, [&] { stop.request_stop(); }), settings)));
}

/// Contents of the forecast.json of `rig-lab wear forecast`, and `provenance`, a sentence.
py::object landings_left(const WearPoints& points, const std::filesystem::path& population, const wear::ForecastRequest& request) {
    std::string provenance;
    const std::string json = [&] {
        const py::gil_scoped_release others_run;
        const wear::PopulationFile by = wear::read_population(population);
        provenance = by.population.provenance.sentence();
        return wear::answer(request, wear::resolved(request), by, campaign_of(points)).json.dump();
    }();
    py::object answer = loaded(json);
    answer["provenance"] = provenance;
    return answer;
}

}  // namespace

void bind_wear(py::module_& m) {
    const wear::FitSettings fit;
    m.def(
        "fit_wear",
        [](Numbers energy_J, Numbers friction, std::size_t components, int starts, std::uint64_t seed, double floor, std::string source,
           std::string origin, unsigned threads) {
            wear::FitSettings settings{.max_components = components, .starts = starts, .seed = seed, .em = {}};
            settings.em.covariance_floor = floor;
            return fit_wear({std::move(energy_J), std::move(friction), std::move(source), std::move(origin), {}}, settings, threads);
        },
        py::arg("energy_J"), py::arg("friction"), py::kw_only(), py::arg("components") = fit.max_components, py::arg("starts") = fit.starts,
        py::arg("seed") = fit.seed, py::arg("floor") = fit.em.covariance_floor, py::arg("source") = "arrays", py::arg("origin") = "",
        py::arg("threads") = 0);
    const wear::ForecastRequest ask;
    m.def(
        "landings_left",
        [](Numbers energy_J, Numbers friction, const std::filesystem::path& population, std::optional<double> limit, std::string mix, double slip,
           std::optional<double> energy_MJ, std::size_t last, std::string method, int horizon, int draws, std::uint64_t seed,
           const std::pair<Numbers, Numbers>& lining, const Directory& config) {
            const wear::ForecastRequest request{.config = directory_of(config),
                                                .limit = limit,
                                                .mix = std::move(mix),
                                                .slip = slip,
                                                .energy_MJ = energy_MJ,
                                                .last = last,
                                                .method = std::move(method),
                                                .horizon = horizon,
                                                .draws = draws,
                                                .seed = seed};
            return landings_left({std::move(energy_J), std::move(friction), "arrays", {}, readings_of(lining.first, lining.second)}, population,
                                 request);
        },
        py::arg("energy_J"), py::arg("friction"), py::arg("population"), py::kw_only(), py::arg("limit") = py::none(), py::arg("mix") = ask.mix,
        py::arg("slip") = ask.slip, py::arg("energy_MJ") = py::none(), py::arg("last") = ask.last, py::arg("method") = ask.method,
        py::arg("horizon") = ask.horizon, py::arg("draws") = ask.draws, py::arg("seed") = ask.seed, py::arg("lining") = std::pair<Numbers, Numbers>(),
        py::arg("config") = py::none());
}

}  // namespace plant_sim::python
