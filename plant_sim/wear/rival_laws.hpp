/// Laws of a brake's friction over its life, none of them a Gaussian mixture, so that forecasts are judged by other laws than they are made from
/// (arena.hpp).
///
/// Wear, heat and film are relative: 1 is a used-up lining, the heat of a mean landing, a full film. Constants are assumed [A]; the form of each law
/// is that of the source beside it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "rig_bridge/wear/forecast.hpp"

namespace wear::arena {

enum class Law : std::uint8_t {
    archard,       ///< worn volume is proportional to energy (Archard 1953), and larger in a hot brake, whose friction fades
    ostermeyer,    ///< contact patches grow with friction power and are destroyed by wear (Ostermeyer, Wear 254, 2003, p. 852)
    oxidation,     ///< carbon oxidises by Arrhenius' law; friction depends on the root of the oxidised part (after McKee, Carbon 25, 1987)
    glazing,       ///< light landings build up a glaze, heavy ones break it [A]
    step_faults,   ///< Archard, with sudden permanent losses of 3 to 8 %, two in a mean life [A]
    sensor_drift,  ///< Archard; the pressure sensor's gain drifts, so that friction is measured wrong but the brake is unaffected [A]
};
constexpr std::array<const char*, 6> kLawNames{"archard", "ostermeyer", "oxidation", "glazing", "step_faults", "sensor_drift"};

struct Settings {
    std::uint64_t training = 0, tuning = 0, held_out = 0;  ///< first seeds
    double limit = 0.0;
    double life_landings = 0.0;
    double life_scatter = 0.0;
    double correlation = 0.0;
    std::size_t reading_every = 0;  ///< landings between readings of the lining
    double reading_error = 0.0;     ///< standard deviation
    LandingMix mix;                 ///< with a scatter of 3 % about each kind's energy
    [[nodiscard]] double mean_energy_J() const;
};
/// Throws settings::Error.
[[nodiscard]] Settings load_settings(const std::filesystem::path& file);

class Brake {
  public:
    Brake(Law law, const Settings& settings, std::uint64_t seed);

    /// One landing in which the brake takes `energy_J`; returns the measured friction.
    double land(double energy_J, Generator& generator);
    /// Expected measured friction of the next landing.
    [[nodiscard]] double expected() const;
    /// True friction at mean heat and glaze, which decides whether the brake is worn out.
    [[nodiscard]] double condition() const;
    [[nodiscard]] double life_J() const { return life_J_; }
    [[nodiscard]] double level() const { return level_; }
    [[nodiscard]] double worn() const { return worn_; }
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
    double lost_ = 0.0;  // by steps
    double misread_ = 1.0;
};

[[nodiscard]] double landing_energy_J(const Settings& settings, Generator& generator);

/// Landings of a new brake in which low friction is no wear: patches are not there yet.
inline constexpr int kRunIn = 20;

/// A brake from new to worn out.
struct Life {
    Campaign campaign;
    std::vector<Brake> before;  ///< state of the brake before each landing
    [[nodiscard]] std::size_t landings() const { return before.size(); }
};
[[nodiscard]] Life live(Law law, const Settings& settings, std::uint64_t seed);

}  // namespace wear::arena
