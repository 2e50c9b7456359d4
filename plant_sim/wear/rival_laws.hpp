/// Laws of a brake's friction over its life, none of them a Gaussian mixture: what judges forecasts (arena.hpp) is not what makes them.
///
/// Worn, heat and film are shares: 1 is a used-up lining, the heat of a mean landing, a full film. Constants are made up [A]; forms are of
/// the source that stands at each law.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "rig_bridge/wear/forecast.hpp"

namespace wear::arena {

enum class Law : std::uint8_t {
    archard,       ///< worn volume goes with energy (Archard 1953), and faster in a hot brake, whose friction fades
    ostermeyer,    ///< contact patches grow with friction power and are destroyed by wear (Ostermeyer, Wear 254, 2003, p. 852)
    oxidation,     ///< carbon burns off by Arrhenius' law; grip goes with the root of what is burnt (after McKee, Carbon 25, 1987)
    glazing,       ///< a glaze grows in light landings and heavy ones break it [A]
    step_faults,   ///< Archard; sudden losses of 3 to 8 % that stay, two in a mean life [A]
    sensor_drift,  ///< Archard; pressure is read with a gain that walks, so that friction is misread, while the brake is not [A]
};
constexpr std::array<const char*, 6> kLawNames{"archard", "ostermeyer", "oxidation", "glazing", "step_faults", "sensor_drift"};

struct Settings {
    std::uint64_t training = 0, tuning = 0, held_out = 0;  ///< first seeds
    double limit = 0.0;
    double life_landings = 0.0;
    double life_scatter = 0.0;
    double correlation = 0.0;
    LandingMix mix;  ///< scatter of 3 % about each kind's energy
    [[nodiscard]] double mean_energy_J() const;
};
/// Throws settings::Error.
[[nodiscard]] Settings load_settings(const std::filesystem::path& file);

class Brake {
  public:
    Brake(Law law, const Settings& settings, std::uint64_t seed);

    /// A landing: the friction that is read in it, and the brake has taken `energy_J`.
    double land(double energy_J, Generator& generator);
    /// Friction that the next landing will be read with, without what is new in it.
    [[nodiscard]] double expected() const;
    /// Friction at mean heat and glaze, not misread: what decides that the brake is worn out.
    [[nodiscard]] double condition() const;
    [[nodiscard]] double life_J() const { return life_J_; }
    [[nodiscard]] double level() const { return level_; }
    /// The same brake with another life and level: it has taken the same energy and is worn accordingly.
    [[nodiscard]] Brake with(double life_J, double level) const;
    /// Standard deviation of what is new in each reading.
    static constexpr double kFresh = 0.003;

  private:
    Law law_;
    double life_J_;
    double mean_J_;
    double level_;
    double worn_ = 0.0;
    double heat_ = 1.0;
    double film_ = 0.0;
    double lost_ = 0.0;  // to steps
    double misread_ = 1.0;
};

[[nodiscard]] double landing_energy_J(const Settings& settings, Generator& generator);

/// A brake from new to worn out.
struct Life {
    Campaign campaign;
    std::vector<Brake> before;  ///< the brake as it is before each landing
    [[nodiscard]] std::size_t landings() const { return before.size(); }
};
[[nodiscard]] Life live(Law law, const Settings& settings, std::uint64_t seed);

}  // namespace wear::arena
