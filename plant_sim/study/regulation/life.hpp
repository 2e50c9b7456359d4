/// The life of one brake and one tyre between two plans: landings drawn at random, brake and tyre lasting as long as they really do, the slip
/// reference chosen by a policy. A life asks for its landings; how they are made is not its business.
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

/// How references are chosen.
struct Policy {
    std::string name;
    std::optional<double> fixed{};  ///< this one throughout; none: regulated
    bool inspected = true;          ///< where the lives have inspections
    bool forecast = false;          ///< the brake's life by its friction, where nobody inspects
    bool told = false;              ///< the surface, before each landing: a reference for each
    bool bound = false;             ///< Bound::best() for what is really left
    int every = 1;                  ///< landings after which the reference is set again
};

/// What an inspection is like.
struct Inspection {
    int landings = 0;    ///< between two, the first at the plan's begin; 0: none
    double error = 0.0;  ///< standard deviation of the worn part that is read, of brake and of tyre, over the whole of a new one
    /// What is believed beforehand of the lives of brake and tyre.
    double brake_spread = 0.12, tyre_spread = 0.1;
};

struct LifeOptions {
    Policy policy;
    wear::BrakeWear brake;     ///< as it really is; its life may differ from the plan's
    double tyre_life_J = 0.0;  ///< true
    wear::ConditionalRule rule;
    std::uint64_t brake_seed = 1;
    Inspection inspection{};
    /// Of each scenario's surface what the floor allows there, learnt with its first landing: Regulator::narrow(). Empty: the range given has
    /// all surfaces in it.
    std::vector<wear::Range> allowed_on{};
    std::vector<std::size_t> surface_of{};                ///< of each scenario, as `references` and `bound` count them
    std::optional<wear::SurfaceReferences> references{};  ///< for who is told the surface
    std::optional<wear::LifeForecast> life_forecast{};    ///< of the brake as planned
    const Bound* bound = nullptr;                         ///< what each landing loses is reckoned with it
    Costs costs{};
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
    double loss = 0.0;          ///< Bound::loss(), to the first limit
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
    double cost = 0.0;           ///< of wear, distance and visits, to the first limit: see Bound
    double loss = 0.0;           ///< of that, what the bound's policy would have saved in the mean
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
    [[nodiscard]] bool regulated() const { return !options_.policy.fixed && !options_.policy.bound; }
    [[nodiscard]] bool inspected() const { return regulated() && options_.policy.inspected && options_.inspection.landings > 0; }
    [[nodiscard]] Pair left() const;
    [[nodiscard]] double next_reference() const;
    void inspect();
    void regulate(const Draw& draw, const Stop& stop, double reference);

    wear::Range range_;  // of all surfaces seen so far
    std::vector<Draw> draws_;
    LifeOptions options_;
    wear::Regulator regulator_;
    wear::LifeReadings brake_readings_, tyre_readings_;
    double held_;  // the regulator's reference when it was last taken over
    wear::WearingBrake brake_;
    Life life_;
    double brake_J_ = 0.0;
    double tyre_J_ = 0.0;
};

}  // namespace regulation
