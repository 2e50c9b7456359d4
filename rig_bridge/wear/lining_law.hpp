/// How a lining wears, as physics and not as a fitted model: contact area that runs in, a lining that wears as Archard (1953) says, a core that
/// loses grip when the lining is nearly gone; scatter from the temperature that the maneuver before left behind, which remembers, and from
/// hysteresis (a play operator) in how friction follows it. No Gaussian mixture is in it, so that a wear model fitted to its campaigns is not
/// judged by itself. Numbers are assumptions [A].
#pragma once

#include <cstdint>

#include "rig_bridge/wear/draw.hpp"

namespace wear {

struct LiningLaw {
    double plateau = 0.26;             ///< friction of a run-in brake with all of its lining
    double run_in = 0.06;              ///< above the plateau while the contact is new
    double run_in_J = 12e6;            ///< that the contact takes to run in
    double loss = 0.04;                ///< over the whole lining, linear in what is worn
    double lining_J = 500e6;           ///< that the lining lasts
    double core_loss = 0.05;           ///< lost at the end
    double core_share = 0.06;          ///< of the lining's life in which the core is met
    double per_temperature = -0.0035;  ///< change of friction a standard deviation of temperature
    double memory = 0.6;               ///< of temperature from one maneuver to the next, 0 to 0.75
    double play = 0.8;                 ///< half width of the hysteresis, in deviations of temperature
    double measurement = 0.0012;       ///< standard deviation of what is new in each maneuver
    bool operator==(const LiningLaw&) const = default;
};

/// Temperature from maneuver to maneuver, in deviations from its mean, and what friction follows of it.
class LiningTemperature {
  public:
    explicit LiningTemperature(Generator& generator) : temperature_(normal(generator)), following_(temperature_) {}

    /// One maneuver on.
    void step(const LiningLaw& law, Generator& generator);
    [[nodiscard]] double temperature() const { return temperature_; }
    [[nodiscard]] double following() const { return following_; }

  private:
    double temperature_;
    double following_;  // lags behind temperature within the play
};

/// Friction without scatter when `worn_J` >= 0 of the lining is used up.
[[nodiscard]] double expected_friction(const LiningLaw& law, double worn_J);

/// Mean friction of maneuver `number` of the brake `seed`: a pure function of these and of what is worn, so that a brake goes on anywhere. Of the
/// temperatures it knows those of 24 maneuvers back.
[[nodiscard]] double friction(const LiningLaw& law, std::uint64_t seed, std::uint64_t number, double worn_J);

}  // namespace wear
