/// Brakes of one kind that differ as brakes do: each follows the law of physical_campaign.hpp with parameters of its own, in life, level,
/// run-in, wear-out and scatter. Whoever forecasts sees none of it.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "tests/wear/physical_campaign.hpp"

namespace physical {

inline BrakeLaw brake_of_fleet(std::uint64_t seed) {
    wear::Generator generator = wear::generator_of(seed, 1);
    const auto times = [&](double mean, double relative) { return mean * std::exp(relative * wear::normal(generator)); };
    BrakeLaw law;
    law.plateau += 0.006 * wear::normal(generator);
    law.run_in = times(law.run_in, 0.20);
    law.run_in_J = times(law.run_in_J, 0.35);
    law.loss = times(law.loss, 0.25);
    law.lining_J = times(law.lining_J, 0.12);
    law.core_loss = times(law.core_loss, 0.20);
    law.core_share = 0.04 + 0.10 * wear::uniform(generator);
    law.per_temperature = -times(0.0035, 0.20);
    law.memory = 0.45 + 0.30 * wear::uniform(generator);
    law.play = 0.5 + 0.6 * wear::uniform(generator);
    law.measurement = times(law.measurement, 0.20);
    return law;
}

/// A campaign as a rig runs it: until a maneuver's friction is below the wear limit.
struct WornOut {
    wear::Campaign campaign;
    std::vector<double> expected;  ///< friction without scatter, maneuver by maneuver

    /// Maneuvers until the friction without scatter is below `limit`; none: it never is.
    [[nodiscard]] std::optional<std::size_t> life(double limit) const {
        for (std::size_t i = 0; i < expected.size(); ++i)
            if (expected[i] < limit) return i;
        return std::nullopt;
    }
};

inline WornOut worn_out(std::uint64_t seed, double wear_limit = 0.165) {
    WornOut out;
    out.campaign = campaign(brake_of_fleet(seed), seed, &out.expected, 1500);
    std::size_t n = 0;
    while (n < out.expected.size() && out.campaign.points[n].mean_friction >= wear_limit) ++n;
    n = std::min(n + 1, out.expected.size());
    out.campaign.points.resize(n);
    out.expected.resize(n);
    return out;
}

}  // namespace physical
