/// A simulated brake with wear: each maneuver increases c_e, and the mean friction of the next is drawn by the law of its lining, if its rig has one,
/// else from a fitted model by eq. (14). Two factors scale a law or model of another brake.
///
///     wear::WearingBrake brake(wear, rule, {.seed = 1});
///     for (;;) brake.take(energy_of_a_stop_with(brake.next_friction()));
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "rig_bridge/wear/lining_law.hpp"
#include "rig_bridge/wear/model.hpp"

namespace wear {

/// Complete state of one brake; sufficient to continue it later or elsewhere.
struct BrakeState {
    std::uint64_t seed = 1;
    std::uint64_t maneuvers = 0;  ///< since the brake was new, or since the simulation began
    double c_e_J = 0.0;           ///< energy taken so far
    bool operator==(const BrakeState&) const = default;
};

/// Lower limit of drawn friction, so that every simulated stop ends.
inline constexpr double kMinFriction = 0.01;

/// Scale from the brake of model and law to this one.
struct BrakeScale {
    double energy = 1.0;    ///< this brake takes so many times the energy for the same wear
    double friction = 1.0;  ///< its friction is so many times theirs
    bool operator==(const BrakeScale&) const = default;
};

/// How one brake wears: `[brake.wear]` of landing_gear.toml and flywheel_rig.toml, read by load_brake_wear.hpp.
struct BrakeWear {
    std::shared_ptr<const Model> model;  ///< used by forecasts
    BrakeScale scale;
    double life_J = 0.0;             ///< the energy at which it counts as worn out
    std::filesystem::path file;      ///< of the model, for the hash of results
    std::optional<LiningLaw> law{};  ///< how it wears; none: by the model
};

/// One draw of the mean mu_b of a maneuver that begins when the brake has taken `c_e_J` >= 0, eq. (14); at least
/// kMinFriction. For studies that ask for one landing at a given wear.
[[nodiscard]] double friction_at(const Model& model, const BrakeScale& scale, const ConditionalRule& rule, double c_e_J, Generator& generator);

/// The mean of those draws, without scatter.
[[nodiscard]] double expected_friction_at(const Model& model, const BrakeScale& scale, const ConditionalRule& rule, double c_e_J);

class WearingBrake {
  public:
    /// Throws std::invalid_argument for no model, a scale or life that is not positive, and an energy that is negative or not finite.
    WearingBrake(BrakeWear wear, const ConditionalRule& rule, const BrakeState& state);

    /// Mean mu_b of the next maneuver: a pure function of seed, maneuver number and c_e, constant until take() is called.
    [[nodiscard]] double next_friction() const;
    /// Whether next_friction() is drawn from the model beyond its data (kHowItExtrapolates).
    [[nodiscard]] bool extrapolates() const;
    /// Call after the maneuver with its brake energy >= 0, eq. (9). Throws std::invalid_argument for other values.
    void take(double brake_energy_J);

    [[nodiscard]] const BrakeState& state() const { return state_; }
    [[nodiscard]] const BrakeWear& wear() const { return wear_; }
    [[nodiscard]] const ConditionalRule& rule() const { return rule_; }
    [[nodiscard]] double life_J() const { return wear_.life_J; }

  private:
    BrakeWear wear_;
    ConditionalRule rule_;
    BrakeState state_;
    std::optional<LiningScatter> scatter_;  // by the law
};

}  // namespace wear
