#include "rig_bridge/bridge/landings_left.hpp"

#include <fmt/core.h>

#include <optional>

#include "rig_bridge/replay/campaign_source.hpp"
#include "rig_bridge/wear/landings_forecast.hpp"
#include "rig_bridge/wear/population_io.hpp"
#include "rig_bridge/wear/wear_campaign.hpp"

namespace rig::bridge {

std::string landings_left(const std::filesystem::path& model, const std::vector<record::LedgerRow>& rows, double min_friction) {
    constexpr std::size_t kNewest = 100;  // whose energies the landings to come have
    const wear::Campaign campaign = replay::wear_of(rows);
    if (campaign.points.size() < 2 || !(min_friction > 0.0)) return {};
    const wear::PopulationFile file = wear::read_population(model);
    wear::LandingsForecast brake(file.population);
    brake.learn(campaign);
    const wear::ForecastSettings settings{.limit = min_friction, .horizon = 3000, .draws = 400};
    const wear::Forecast f = brake.forecast(wear::mix_of(campaign, kNewest), settings);
    const std::string by = file.population.provenance.sentence();
    if (f.already_crossed()) return fmt::format("none: mean friction is below {:g}, by brakes {}", min_friction, by);
    const auto text = [&](const std::optional<int>& landings) {
        return landings ? fmt::format("{}", *landings) : fmt::format("over {}", settings.horizon);
    };
    return fmt::format("{} ({} to {}, 10 to 90 %) to mean friction {:g}, by brakes {}", text(f.landings_left[1]), text(f.landings_left[0]),
                       text(f.landings_left[2]), min_friction, by);
}

}  // namespace rig::bridge
