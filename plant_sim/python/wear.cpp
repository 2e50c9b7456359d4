#include "plant_sim/python/wear.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <stop_token>

#include "plant_sim/python/interruptible.hpp"
#include "rig_bridge/wear/model_io.hpp"
#include "rig_bridge/wear/on_threads.hpp"
#include "rig_bridge/wear/population_io.hpp"

namespace plant_sim::python {

namespace py = pybind11;

namespace {

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

}  // namespace

std::vector<wear::LiningReading> readings_of(const std::vector<double>& energy_J, const std::vector<double>& worn) {
    if (energy_J.size() != worn.size())
        throw std::invalid_argument(
            fmt::format("lining: {} energies and {} worn shares: expected one of each a reading", energy_J.size(), worn.size()));
    std::vector<wear::LiningReading> readings;
    readings.reserve(worn.size());
    for (std::size_t i = 0; i < worn.size(); ++i) readings.push_back({energy_J[i], worn[i]});
    return readings;
}

py::object fit_wear(const WearPoints& points, const wear::FitSettings& settings, unsigned threads) {
    const wear::Campaign campaign = campaign_of(points);
    std::stop_source stop;
    const auto fit = [&] {
        return wear::fit(campaign, settings, {.threads = threads > 0 ? threads : wear::all_cores(), .stop = stop.get_token(), .progress = {}});
    };
    return loaded(wear::to_json(wear::model_of(campaign, interruptible(fit, [&] { stop.request_stop(); }), settings)));
}

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

}  // namespace plant_sim::python
