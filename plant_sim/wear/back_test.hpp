/// Does a forecast hold? Asked of brakes whose end is known, with what was known at a part of their life.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "rig_bridge/wear/forecast.hpp"

namespace wear {

struct HeldOut {
    Campaign campaign;
    std::size_t life = 0;  ///< maneuvers until the mean friction was below the limit: the truth
};

/// Where no truth is at hand: the mixture is fitted to the whole campaign, and the first maneuver at which its mean curve is below the limit
/// is the life. None: it never is.
[[nodiscard]] std::optional<std::size_t> life_by_fit(const Campaign& campaign, double limit, const FitSettings& settings);

struct BackTestRow {
    double share_of_life = 0.0;
    std::size_t asked = 0;
    std::size_t held = 0;     ///< the 10 to 90 % interval has the truth, its ends included
    std::size_t earlier = 0;  ///< the truth came before it
    std::size_t later = 0;
    double mean_width = 0.0;  ///< of the interval, landings; ends beyond the horizon count as the horizon
    double mean_error = 0.0;  ///< of the median, absolute, landings

    [[nodiscard]] double coverage() const { return asked == 0 ? 0.0 : static_cast<double>(held) / static_cast<double>(asked); }
};

/// At 20, 40, 60 and 80 % of life, and all together.
struct BackTest {
    std::array<BackTestRow, 4> rows{};
    BackTestRow pooled;
};

/// Landings are as the campaign's own so far. `settings.seed` governs all draws.
[[nodiscard]] BackTest back_test(const Population& population, const std::vector<HeldOut>& brakes, const ForecastSettings& settings,
                                 const std::function<void(std::size_t done, std::size_t all)>& progress = {});

}  // namespace wear
