/// Tests forecasts on brakes whose life is known, with the data up to a part of the life.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "rig_bridge/wear/forecast.hpp"

namespace wear {

struct HeldOut {
    Campaign campaign;
    std::size_t life = 0;  ///< true number of maneuvers until the mean friction was below the limit
};

/// Estimate of the life if the truth is unknown: fits the mixture to the whole campaign and returns the first maneuver at which its mean curve is
/// below the limit. None: it never is.
[[nodiscard]] std::optional<std::size_t> life_by_fit(const Campaign& campaign, double limit, const FitSettings& settings);

struct BackTestRow {
    double share_of_life = 0.0;
    std::size_t asked = 0;    ///< number of forecasts
    std::size_t held = 0;     ///< number whose 10 to 90 % interval contains the truth, its ends included
    std::size_t earlier = 0;  ///< number whose truth is below the interval
    std::size_t later = 0;
    double mean_width = 0.0;  ///< of the interval, landings; ends beyond the horizon count as the horizon
    double mean_error = 0.0;  ///< mean absolute error of the median, landings

    [[nodiscard]] double coverage() const { return asked == 0 ? 0.0 : static_cast<double>(held) / static_cast<double>(asked); }
};

/// Results at 20, 40, 60 and 80 % of life, and over all of these.
struct BackTest {
    std::array<BackTestRow, 4> rows{};
    BackTestRow pooled;
};

/// Future landings are taken as in the campaign so far. `settings.seed` determines all draws.
[[nodiscard]] BackTest back_test(const Population& population, const std::vector<HeldOut>& brakes, const ForecastSettings& settings,
                                 const std::function<void(std::size_t done, std::size_t all)>& progress = {});

}  // namespace wear
