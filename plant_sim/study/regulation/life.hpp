/// The life of one brake and one tyre between two plans: landings drawn at random, the brake wearing by its model, the slip reference
/// regulated or fixed. How a landing is made is handed in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "plant_sim/study/regulation/regulator.hpp"
#include "plant_sim/wear/wearing_brake.hpp"

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
[[nodiscard]] std::vector<Draw> draw_life(std::uint64_t seed, std::uint64_t life, std::size_t count,
                                          std::size_t planned, std::size_t scenarios, Mix mix,
                                          double missing);

/// One landing as it was: true, and as it was measured.
struct Stop {
    Landing measured;
    double brake_J = 0.0;
    double tyre_J = 0.0;
    double distance_m = 0.0;
    double j_mu = 0.0;
};
using Lander = std::function<Stop(const Draw&, double reference, double mean_friction)>;

struct LifeOptions {
    std::optional<double> fixed;  ///< this reference throughout; none: regulated
    wear::BrakeWear brake;        ///< as it really is; its life may differ from the plan's
    wear::ConditionalRule rule;
    std::uint64_t brake_seed = 1;
    int inspection =
        0;  ///< landings between two inspections of the brake, which tell its true wear and life; 0: none
    bool worst_stops =
        false;  ///< also land with both ends of the range, to know the distance that the floor stands for
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
    Reading reading = Reading::measured;
};

enum class First : std::uint8_t { brake, tyre };

struct Life {
    std::vector<LifeRow> rows;  ///< to the first limit or the planned landing, whichever is later
    double brake_budget_J = 0.0, tyre_budget_J = 0.0;  ///< true, from the plan's begin
    double brake_at_plan = 0.0, tyre_at_plan = 0.0;    ///< used at the planned landing, over the budget
    First first = First::brake;
    double first_landing = 0.0;  ///< at which the first limit was reached, with its fraction
    double other_left = 0.0;     ///< of the other's budget, unused then
    double brought = 0.0;        ///< energy of the planned landings over both budgets
    bool feasible =
        false;  ///< some reference in the range could have met both limits at the planned landing, within the tolerance
    bool met = false;  ///< both were
    bool floor_held =
        true;  ///< no stop was longer than at the worse end of the range, by more than kDistanceNoise
};

/// A stop varies by this much with what the controller happens to meet; relative.
inline constexpr double kDistanceNoise = 1e-3;

/// `draws` must reach beyond the planned landing; the life ends with them if no limit was reached.
[[nodiscard]] Life live(const Plan& plan, const Rules& rules, const Range& range,
                        const std::vector<Draw>& draws, const LifeOptions& options, const Lander& land);

}  // namespace regulation
