/// Life of one brake and one tyre between two plans: drawn landings, true lives of brake and tyre, slip references by a policy. The life requests
/// landings; the caller runs them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plant_sim/study/regulation/bound.hpp"
#include "rig_bridge/wear/life_forecast.hpp"
#include "rig_bridge/wear/life_readings.hpp"
#include "rig_bridge/wear/regulator.hpp"
#include "rig_bridge/wear/surface_references.hpp"
#include "rig_bridge/wear/wearing_brake.hpp"

namespace regulation {

/// Drawn properties of a landing, the same for every policy.
struct Draw {
    std::size_t scenario = 0;
    std::uint64_t sensor_seed = 0;
    bool measured = true;  ///< whether its figures are known
};

enum class Mix : std::uint8_t {
    random,   ///< each landing is any of the scenarios, as in Section VI
    balanced  ///< within the planned landings every scenario occurs equally often, in random order
};

/// Draws `count` landings of life `life`. `missing`: share of landings without figures.
[[nodiscard]] std::vector<Draw> draw_life(std::uint64_t seed, std::uint64_t life, std::size_t count, std::size_t planned, std::size_t scenarios,
                                          Mix mix, double missing);

/// One landing with its true and its measured values.
struct Stop {
    wear::Landing measured;
    double measured_friction = wear::kUnknown;  ///< mean mu_b over the stop, by eq. (7)
    double brake_J = 0.0;
    double tyre_J = 0.0;
    double distance_m = 0.0;
    double j_mu = 0.0;
};

/// A landing requested by a life.
struct LandingRequest {
    Draw draw;
    double reference = 0.0;
    double mean_friction = 0.0;  ///< of the brake
    bool metered = true;         ///< whether Stop::measured is needed
};

/// Method of choosing references.
struct Policy {
    std::string name;
    std::optional<double> fixed{};  ///< a constant reference; none: regulated
    bool inspected = true;          ///< uses inspections, if the lives have them
    bool forecast = false;          ///< estimates the brake's life from its friction if there are no inspections
    bool told = false;              ///< knows the surface before each landing: one reference per surface
    bool bound = false;             ///< uses Bound::best() with the true remaining energies
    int every = 1;                  ///< number of landings between two changes of the reference
};

/// Properties of inspections.
struct Inspection {
    int landings = 0;    ///< interval, the first at the beginning of the plan; 0: none
    double error = 0.0;  ///< standard deviation of the measured wear of brake and tyre, relative to a new one
    /// Standard deviations of the prior of the lives of brake and tyre, relative.
    double brake_spread = 0.12, tyre_spread = 0.1;
};

struct LifeOptions {
    Policy policy{};
    wear::BrakeWear brake{};   ///< true; its life may differ from the plan's
    double tyre_life_J = 0.0;  ///< true
    wear::ConditionalRule rule{};
    std::uint64_t brake_seed = 1;
    Inspection inspection{};
    /// Allowed range on each scenario's surface, known from its first landing on: Regulator::narrow(). Empty: the given range is valid for all
    /// surfaces.
    std::vector<wear::Range> allowed_on{};
    std::vector<std::size_t> surface_of{};                ///< of each scenario, with the indices of `references` and `bound`
    std::optional<wear::SurfaceReferences> references{};  ///< for policies that know the surface
    std::optional<wear::LifeForecast> life_forecast{};    ///< of the planned brake
    const Bound* bound = nullptr;                         ///< for the loss of each landing; null: not computed
    Costs costs{};
    bool worst_stops = false;  ///< whether to land also at both ends of the range, to determine the distance that the floor limits
};

struct LifeRow {
    double reference = 0.0;
    double required_share = 0.0;  ///< before the landing; 0 for a fixed reference
    double share = 0.0;           ///< true share of the tyre
    double brake_J = 0.0;         ///< cumulative since the beginning of the plan, true
    double tyre_J = 0.0;
    double distance_m = 0.0;
    double worst_distance_m = 0.0;  ///< at the worse end of the range; 0: not requested
    double j_mu = 0.0;
    double brake_life_J = 0.0;  ///< assumed by the regulator before the landing; 0 for a fixed reference
    double loss = 0.0;          ///< Bound::loss() up to the first limit
    bool new_surface = false;   ///< whether the surface was unknown before: the floor does not apply yet
    wear::Reading reading = wear::Reading::measured;
};

enum class First : std::uint8_t { brake, tyre };

struct Life {
    std::vector<LifeRow> rows;                         ///< up to the first limit or the planned landing, whichever is later
    double brake_budget_J = 0.0, tyre_budget_J = 0.0;  ///< true, from the beginning of the plan
    double brake_at_plan = 0.0, tyre_at_plan = 0.0;    ///< used at the planned landing, relative to the budget
    First first = First::brake;
    double first_landing = 0.0;  ///< landing of the first limit, with its fraction
    double other_left = 0.0;     ///< unused part of the other's budget at that time
    double brought = 0.0;        ///< energy of the planned landings relative to both budgets
    bool feasible = false;       ///< whether some reference in the range could have met both limits at the planned landing within the tolerance
    bool met = false;            ///< whether both were met
    double cost = 0.0;           ///< of wear, distance and visits, to the first limit: see Bound
    double loss = 0.0;           ///< part of `cost` that the bound's policy would have saved in the mean
    bool floor_held = true;      ///< whether no stop was longer than at the worse end of the range by more than kDistanceNoise
};

/// Relative scatter of a stop's distance with the sensors' noise. Past the peak of dry concrete, with a worn brake, the noise decides whether a wheel
/// that runs away is caught: heavy landings at slip 0.28 with six seeds scatter by 1 % (one standard deviation).
inline constexpr double kDistanceNoise = 1e-2;

/// An unfinished life:
///
///     for (UnfinishedLife pair(...); !pair.over();) pair.landed(stops_of(pair.requests()));
///     Life life = pair.life();
class UnfinishedLife {
  public:
    /// `draws` must reach beyond the planned landing; the life ends with them if no limit is reached. Throws as Regulator does.
    UnfinishedLife(const wear::WearPlan& plan, const wear::Rules& rules, const wear::Range& range, std::vector<Draw> draws,
                   const LifeOptions& options);

    [[nodiscard]] bool over() const;
    /// The next landing and, if LifeOptions requests it, the same one at both ends of the range. Only before over().
    [[nodiscard]] std::vector<LandingRequest> requests() const;
    /// Takes the results of requests(), in the same order.
    void landed(std::span<const Stop> stops);
    /// The judged life; only after over().
    [[nodiscard]] Life life() const;

  private:
    [[nodiscard]] bool regulated() const { return !options_.policy.fixed && !options_.policy.bound; }
    [[nodiscard]] bool inspected() const { return regulated() && options_.policy.inspected && options_.inspection.landings > 0; }
    [[nodiscard]] Pair left() const;
    [[nodiscard]] double next_reference() const;
    void inspect();
    void regulate(const Draw& draw, const Stop& stop, double reference);

    wear::Range range_;  // common to all surfaces so far
    std::vector<Draw> draws_;
    LifeOptions options_;
    wear::Regulator regulator_;
    wear::LifeReadings brake_readings_, tyre_readings_;
    double held_;  // the regulator's reference at the last change
    wear::WearingBrake brake_;
    Life life_;
    double brake_J_ = 0.0;
    double tyre_J_ = 0.0;
};

}  // namespace regulation
