/// Several aircraft and one workshop, day by day: what brakes, tyres, visits, the ground and stopping distance cost under a policy.
///
/// In the morning aircraft leave the shop, and others enter it. What flies then makes its landings of the day. An aircraft with a brake or a tyre at
/// its limit stands on the ground until its visit is over; so does one that is in the shop. At a visit the part that is due first is changed, and the
/// other one if that costs less than a visit of its own later, as in Bound.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "plant_sim/study/regulation/aircraft.hpp"
#include "plant_sim/study/regulation/bound.hpp"
#include "plant_sim/study/regulation/mean_share.hpp"

namespace regulation {

/// A workshop with a limited number of bays, each visit equally long. Times are days from now.
struct Shop {
    int bays = 1;        ///< aircraft that it takes at the same time, above 0
    int visit_days = 1;  ///< from the morning in which a bay is taken to that in which it is free again, above 0

    /// Latest days at which visits can begin so that each begins by its day of `due`, which must ascend. A day before now: it is too late.
    [[nodiscard]] std::vector<double> latest_starts(std::span<const double> due) const;
    /// Days at which visits begin if none begins before its day of `due`, which must ascend. `busy`: days until which bays are taken, for those that
    /// are.
    [[nodiscard]] std::vector<double> first_come(std::span<const double> due, std::span<const double> busy) const;
};

/// What an owner computes for one aircraft from estimates of what is left of its brake and tyre: how long they last, which mean tyre share makes them
/// last otherwise, and what is worth changing. Wear is taken as linear in energy.
class Economy {
  public:
    /// `costs.visit` includes the days on the ground; `costs.planned` has the expected lives; `landing_J` > 0 is a landing's mean energy. `choices`
    /// must outlive it.
    Economy(const Choices& choices, const Costs& costs, double landing_J) : choices_(&choices), costs_(costs), landing_J_(landing_J) {}

    /// Landings until the first of the parts is used up.
    [[nodiscard]] double landings_left(const Pair& left, const Choice& choice) const;
    /// The share at which the brake and this tyre, or one of the next, last equally long: that of them for which it is nearest to `preferred`.
    [[nodiscard]] const Choice& together(const Pair& left, const Choice& preferred) const;
    /// The share nearest to `choice` at which both parts last for `landings` > 0; if they cannot, the one at which they last equally long.
    [[nodiscard]] const Choice& lasting(const Pair& left, const Choice& choice, double landings) const;
    /// Whether a part with so much left is better changed in a visit of the other part than in one of its own later, as in Costs::at_limit().
    [[nodiscard]] bool brake_worth_changing(double left_J) const;
    [[nodiscard]] bool tyre_worth_changing(double left_J) const;

  private:
    const Choices* choices_;
    Costs costs_;
    double landing_J_;
};

/// When an aircraft goes to the shop.
enum class Visits : std::uint8_t {
    at_limit,      ///< when a part has reached its limit; first come, first served
    earliest_due,  ///< booked by the estimates, so early that no visit comes after its due day: Shop::latest_starts()
    spread,        ///< likewise, after the mean shares were moved so that each aircraft's parts last until a bay is free
};

struct FleetPolicy {
    const Choice* share = nullptr;  ///< not null; references of all landings
    bool together = false;          ///< moves the share so that each aircraft's brake and a tyre are worn out together: Economy::together()
    Visits visits = Visits::at_limit;
    double margin_days = 0.0;  ///< booked visits are due so many days before the estimated limit
    bool own_bay = false;      ///< a bay for each aircraft
};

struct FleetRules {
    Shop shop;
    int landings_a_day = 1;   ///< of each aircraft that flies
    int days = 1;             ///< that are studied
    double ground_day = 0.0;  ///< money, for each day that an aircraft stands on the ground
    wear::Prices prices;
};

struct Visit {
    std::size_t aircraft = 0;
    int grounded = 0;                  ///< day from which it did not fly; `begin` for one that comes before its limit
    int begin = 0;                     ///< the morning in which it got its bay
    bool brake = false, tyre = false;  ///< what was changed
};

/// Money: all that `days` cost. A part counts as far as it is worn, and the rest when it is changed.
struct FleetMoney {
    double brake = 0.0, tyre = 0.0, visit = 0.0, ground = 0.0, distance = 0.0;
    [[nodiscard]] double all() const { return brake + tyre + visit + ground + distance; }
};

struct FleetResult {
    std::int64_t landings = 0;
    double waiting_days = 0.0;  ///< of all aircraft, for a bay; part of ground_days
    double ground_days = 0.0;   ///< with those in the shop, and what was left of the day in which a limit was reached
    double distance_m = 0.0;
    std::vector<Visit> visits;  ///< by their begin
    FleetMoney money;

    [[nodiscard]] double per_landing() const { return money.all() / static_cast<double>(landings); }
};

/// One aircraft for each of `seeds`. `rules.prices` and `economy` should be of the same owner.
[[nodiscard]] FleetResult run_fleet(const AircraftKind& kind, const FleetRules& rules, const Economy& economy, const FleetPolicy& policy,
                                    std::span<const std::uint64_t> seeds);

}  // namespace regulation
