/// The life of one brake and one tyre between two plans: landings drawn at random, the brake wearing by its model, the slip reference
/// regulated or fixed. A life asks for its landings; how they are made is not its business.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "rig_bridge/wear/life_forecast.hpp"
#include "rig_bridge/wear/regulator.hpp"
#include "rig_bridge/wear/wearing_brake.hpp"

namespace regulation {

/// What chance decides of a landing, the same for every policy.
struct Draw {
    std::size_t scenario = 0;
    std::uint64_t sensor_seed = 0;
    bool measured = true;  ///< its figures come through
};

enum class Mix : std::uint8_t {
    random,   ///< every landing any of the scenarios, as in Section VI
    balanced  ///< in the planned landings every scenario as often as any other, in random order
};

/// `count` landings of life `life`; `missing`: share of them whose figures are lost.
[[nodiscard]] std::vector<Draw> draw_life(std::uint64_t seed, std::uint64_t life, std::size_t count, std::size_t planned, std::size_t scenarios,
                                          Mix mix, double missing);

/// One landing as it was: true, and as it was measured.
struct Stop {
    wear::Landing measured;
    double measured_friction = wear::kUnknown;  ///< mean mu_b over the stop, from eq. (7)
    double brake_J = 0.0;
    double tyre_J = 0.0;
    double distance_m = 0.0;
    double j_mu = 0.0;
};

/// A landing that a life asks for.
struct LandingRequest {
    Draw draw;
    double reference = 0.0;
    double mean_friction = 0.0;  ///< of the brake
    bool metered = true;         ///< Stop::measured is wanted, too
};

struct LifeOptions {
    std::optional<double> fixed;  ///< this reference throughout; none: regulated
    wear::BrakeWear brake;        ///< as it really is; its life may differ from the plan's
    wear::ConditionalRule rule;
    std::uint64_t brake_seed = 1;
    int inspection = 0;  ///< landings between two inspections of the brake, which tell its true wear and life; 0: none
    /// Of each scenario's surface what the floor allows there, learnt with its first landing: Regulator::narrow(). Empty: the range given has
    /// all surfaces in it.
    std::vector<wear::Range> allowed_on{};
    /// Of the brake as planned, where nobody inspects it; none: nobody forecasts its life.
    std::optional<wear::LifeForecast> life_forecast{};
    bool worst_stops = false;  ///< also land with both ends of the range, to know the distance that the floor stands for
};

struct LifeRow {
    double reference = 0.0;
    double required_share = 0.0;  ///< before the landing; 0 with a fixed reference
    double share = 0.0;           ///< of the tyre, true
    double brake_J = 0.0;         ///< cumulative, of the plan's begin, true
    double tyre_J = 0.0;
    double distance_m = 0.0;
    double worst_distance_m = 0.0;  ///< at the worse end of the range; 0: not asked for
    double j_mu = 0.0;
    double brake_life_J = 0.0;  ///< that the regulator counted with before it; 0 with a fixed reference
    bool new_surface = false;   ///< nobody knew of this surface: the floor does not bind yet
    wear::Reading reading = wear::Reading::measured;
};

enum class First : std::uint8_t { brake, tyre };

struct Life {
    std::vector<LifeRow> rows;                         ///< to the first limit or the planned landing, whichever is later
    double brake_budget_J = 0.0, tyre_budget_J = 0.0;  ///< true, from the plan's begin
    double brake_at_plan = 0.0, tyre_at_plan = 0.0;    ///< used at the planned landing, over the budget
    First first = First::brake;
    double first_landing = 0.0;  ///< at which the first limit was reached, with its fraction
    double other_left = 0.0;     ///< of the other's budget, unused then
    double brought = 0.0;        ///< energy of the planned landings over both budgets
    bool feasible = false;       ///< some reference in the range could have met both limits at the planned landing, within the tolerance
    bool met = false;            ///< both were
    bool floor_held = true;      ///< no stop was longer than at the worse end of the range, by more than kDistanceNoise
};

/// A stop varies by this much with what the controller happens to meet; relative. Past the peak of dry concrete, with a worn brake, sensors'
/// noise decides whether a wheel that runs away is caught: heavy landings at slip 0.28 with six seeds scatter by 1 % (one standard deviation).
inline constexpr double kDistanceNoise = 1e-2;

/// A life under way:
///
///     for (LivingPair pair(...); !pair.over();) pair.landed(stops_of(pair.requests()));
///     Life life = pair.life();
class LivingPair {
  public:
    /// `draws` must reach beyond the planned landing; the life ends with them if no limit was reached. Throws as Regulator does.
    LivingPair(const wear::WearPlan& plan, const wear::Rules& rules, const wear::Range& range, std::vector<Draw> draws, const LifeOptions& options);

    [[nodiscard]] bool over() const;
    /// The next landing, and where LifeOptions asks for them the same one at both ends of the range. Not once it is over.
    [[nodiscard]] std::vector<LandingRequest> requests() const;
    /// What became of requests(), in their order.
    void landed(std::span<const Stop> stops);
    /// Judged; once it is over.
    [[nodiscard]] Life life() const;

  private:
    void regulate(const Draw& draw, const Stop& stop);

    wear::Range range_;  // of all surfaces seen so far
    std::vector<Draw> draws_;
    LifeOptions options_;
    wear::Regulator regulator_;
    std::optional<wear::LifeForecast> life_forecast_;
    wear::WearingBrake brake_;
    Life life_;
    double brake_J_ = 0.0;
    double tyre_J_ = 0.0;
};

}  // namespace regulation
