#include "plant_sim/wear/forecast_request.hpp"

#include <array>
#include <stdexcept>
#include <utility>

#include "firmware/host/settings/hash.hpp"
#include "plant_sim/study/json_number.hpp"
#include "rig_bridge/wear/landings_forecast.hpp"
#include "rig_bridge/wear/model_io.hpp"

namespace wear {

namespace {

using settings::Json;
using study::or_null;

LandingMix landings_to_come(const ForecastRequest& request, ResolvedRequest& resolved, const Campaign& campaign) {
    constexpr std::size_t kMixOfNewest = 100;
    if (request.energy_MJ) return {{"given", 1.0, *request.energy_MJ * 1e6, 0.0}};
    if (request.mix.empty()) return mix_of(campaign, kMixOfNewest);
    const ConfiguredMix configured = configured_mix(request.config, request.mix, request.slip);
    resolved.files.insert(resolved.files.end(), configured.files.begin(), configured.files.end());
    return configured.mix;
}

Json json_of(const LandingMix& mix) {
    Json kinds = Json::array();
    for (const LandingKind& kind : mix)
        kinds.push_back({{"name", kind.name}, {"share", kind.share}, {"energy_J", kind.energy_J}, {"deviation_J", kind.deviation_J}});
    return kinds;
}

}  // namespace

ResolvedRequest resolved(const ForecastRequest& request) {
    ResolvedRequest out;
    if (!request.limit) {
        out.reserve = reserve_limit(request.config);
        out.files = out.reserve->files;
    }
    out.settings.limit = request.limit ? *request.limit : out.reserve->friction;
    out.settings.horizon = request.horizon;
    out.settings.draws = request.draws;
    out.settings.seed = request.seed;
    return out;
}

ForecastAnswer answer(const ForecastRequest& request, ResolvedRequest resolved, const PopulationFile& by, const Campaign& campaign) {
    if (request.method != "shipped" && request.method != "filter")
        throw std::invalid_argument("method: '" + request.method + "' is none of shipped, filter");
    const LandingMix mix = landings_to_come(request, resolved, campaign);
    LandingsForecast brake(by.population);
    const std::size_t n = campaign.points.size();
    brake.learn(campaign, request.last == 0 || request.last >= n ? 0 : n - request.last);
    const Forecast f =
        request.method == "filter" ? forecast(brake.filter(), taken_now_J(campaign), mix, resolved.settings) : brake.forecast(mix, resolved.settings);
    Json json = json_head(resolved, by);
    json["data_hash"] = data_hash(campaign);
    json["maneuvers"] = n;
    json["lining_readings"] = by.population.curves.lining.lives > 0 && request.method != "filter" ? campaign.readings.size() : 0;
    json["cumulative_energy_J"] = f.c_e_J;
    json["landings_to_come"] = json_of(mix);
    json["horizon"] = resolved.settings.horizon;
    json["draws"] = resolved.settings.draws;
    json["method"] = request.method;
    json["of_their_kind"] = f.population_probability;
    json["already_below"] = f.crossed_now;
    json["below_within_horizon"] = f.crossed_ever;
    json["extrapolated"] = f.extrapolated;
    constexpr std::array kKeys{"10", "50", "90"};
    for (std::size_t q = 0; q < kKeys.size(); ++q) {
        json["mean_friction_now"][kKeys.at(q)] = f.friction_now.at(q);
        json["landings_left"][kKeys.at(q)] = f.landings_left.at(q) ? Json(*f.landings_left.at(q)) : Json();
        json["crossing_J"][kKeys.at(q)] = or_null(f.crossing_J.at(q));
    }
    return {f, mix, std::move(json)};
}

Json json_head(const ResolvedRequest& resolved, const PopulationFile& by) {
    Json json{{"version", ANTISKID_VERSION},
              {"seed", resolved.settings.seed},
              {"model_hash", by.hash},
              {"learnt_from", json_of(by.population.provenance)},
              {"limit", resolved.settings.limit}};
    if (!resolved.files.empty()) json["config_hash"] = settings::hash(resolved.files);
    return json;
}

}  // namespace wear
