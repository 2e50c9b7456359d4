/// A brake whose mean friction wears, from maneuver to maneuver: c_e grows by what each takes, and the mean friction of the next is drawn: by the
/// law of its lining where its rig has one, else from a fitted model by eq. (14). Either may be of another brake; two numbers scale it.
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

/// All that one brake remembers; enough to go on later, elsewhere, as if nothing had been between.
struct BrakeState {
    std::uint64_t seed = 1;
    std::uint64_t maneuvers = 0;  ///< since the brake was new, or since it was taken up
    double c_e_J = 0.0;           ///< that it has taken
    bool operator==(const BrakeState&) const = default;
};

/// No friction is drawn below this: a brake with less would not be one, and no plant could stop.
inline constexpr double kMinFriction = 0.01;

/// From the brake of model and law to this one.
struct BrakeScale {
    double energy = 1.0;    ///< this brake takes so many times the energy for the same wear
    double friction = 1.0;  ///< its friction is so many times theirs
    bool operator==(const BrakeScale&) const = default;
};

/// How one brake wears: `[brake.wear]` of landing_gear.toml and flywheel_rig.toml, read by load_brake_wear.hpp.
struct BrakeWear {
    std::shared_ptr<const Model> model;  ///< what forecasts believe of it
    BrakeScale scale;
    double life_J = 0.0;             ///< the energy at which it counts as worn out
    std::filesystem::path file;      ///< of the model, for the hash of results
    std::optional<LiningLaw> law{};  ///< how it wears; none: as the model says
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

    /// Mean mu_b of the maneuver that comes next: a pure function of seed, number of the maneuver and c_e, the same until take() is called.
    [[nodiscard]] double next_friction() const;
    /// Whether next_friction() is drawn from the model beyond its data; kHowItExtrapolates says how it is found then.
    [[nodiscard]] bool extrapolates() const;
    /// The maneuver took `brake_energy_J` >= 0, eq. (9). Throws std::invalid_argument for anything else.
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
