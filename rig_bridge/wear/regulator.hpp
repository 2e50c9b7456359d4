/// Divides wear between brake and tyre, landing by landing, by the slip reference. Pure: measured landings in, next reference out; no plant, clock,
/// file or randomness. The same landings give the same references, so that a regulator can be rebuilt from past measurements.
///
///     Regulator regulator(plan, rules, range);
///     for (each landing) {
///         land_with(regulator.reference());
///         regulator.after(measured);
///     }
///
/// The tyre takes a share of a landing's energy about equal to the slip, the brake the rest (eq. 8 and 9). With B and T left to brake and tyre, a
/// tyre share of T / (T + B) uses up both together, whatever the landings; at the planned landing if the landings until then bring T + B in total.
/// docs/engineering/regulation.md has the proof that the remaining ratio is held, and its conditions.
#pragma once

#include <cstdint>
#include <limits>

#include "rig_bridge/wear/floor.hpp"

namespace wear {

/// The goal. Energies in J, all above 0 except those taken.
struct WearPlan {
    int landings = 0;  ///< both limits shall be reached with this one, counted from the plan's begin
    double brake_life_J = 0.0;
    double brake_taken_J = 0.0;  ///< before the plan's begin; below the life
    double tyre_life_J = 0.0;
    double tyre_taken_J = 0.0;
    double landing_J = 0.0;  ///< kinetic energy of a landing, expected mean and standard deviation
    double landing_deviation_J = 0.0;
    double tolerance = 0.02;  ///< allowed deviation at the planned landing, as share of what each may take in the plan

    [[nodiscard]] double brake_budget_J() const { return brake_life_J - brake_taken_J; }
    [[nodiscard]] double tyre_budget_J() const { return tyre_life_J - tyre_taken_J; }
};

struct Rules {
    double default_reference = 0.24;  ///< before the first measurement, and when measurements are missing
    double step = 0.02;               ///< largest change of the reference from one landing to the next
    int max_unmeasured_landings = 3;  ///< landings without measurement after which it goes back to the default
    double energy_tolerance = 0.1;    ///< largest plausible relative difference of brake + tyre energy from kinetic energy
    double j_mu_floor = 0.85;
    double adaptation = 0.05;  ///< weight of the newest landing in the share that a reference gives, once settled
};

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Measurements of one landing. NaN: not measured.
struct Landing {
    double reference = kUnknown;       ///< in force
    double expected_share = kUnknown;  ///< of the tyre, by a table for this reference on its surface; NaN: the reference itself
    double kinetic_J = kUnknown;       ///< eq. (8)
    double brake_J = kUnknown;         ///< eq. (9)
    double tyre_J = kUnknown;
    double j_mu = kUnknown;          ///< eq. (16)
    double brake_wear_J = kUnknown;  ///< c_e, all that the brake has taken since new, this landing included; NaN: added up here
};

/// Whether a landing's measurement was used.
enum class Reading : std::uint8_t {
    measured,
    missing,          ///< a figure is absent or no number
    negative,         ///< an energy is below zero
    beyond_kinetic,   ///< tyre or brake took more than the kinetic energy
    energy_mismatch,  ///< brake plus tyre energy differs from the kinetic energy
    counter_back,     ///< the brake's cumulative energy decreased
};
[[nodiscard]] const char* name(Reading reading);

class Regulator {
  public:
    /// `range`: references that the floor allows, see allowed(). Throws std::invalid_argument for an impossible plan or rules, and for a default
    /// outside `range`.
    Regulator(const WearPlan& plan, const Rules& rules, const Range& range);

    /// Reference for the next landing, always within range().
    [[nodiscard]] double reference() const { return reference_; }

    /// Call after every landing. One that is not `measured` is counted with expected energy and share; after `max_unmeasured_landings` of them
    /// the reference moves stepwise to the default.
    Reading after(const Landing& landing);
    /// Adds energy spent without a landing, e.g. in an aborted maneuver; NaN and negative values are ignored.
    void spent(double brake_J, double tyre_J);
    /// Sets a new estimate of the life, from friction or an inspection; false, without effect, if it is NaN or not positive.
    bool revise_brake_life(double life_J);
    bool revise_tyre_life(double life_J);
    /// Narrows the range for a further surface; never widens it. Throws std::invalid_argument for a range without the default.
    void narrow(const Range& range);

    [[nodiscard]] const WearPlan& plan() const { return plan_; }
    [[nodiscard]] const Rules& rules() const { return rules_; }
    [[nodiscard]] const Range& range() const { return range_; }
    [[nodiscard]] int landings() const { return landings_; }
    [[nodiscard]] int missed() const { return missed_; }  ///< in a row, up to the newest landing
    [[nodiscard]] Reading last_reading() const { return last_reading_; }
    [[nodiscard]] double brake_used_J() const { return brake_J_; }  ///< since new
    [[nodiscard]] double tyre_used_J() const { return tyre_J_; }
    [[nodiscard]] double brake_left_J() const;  ///< never below 0
    [[nodiscard]] double tyre_left_J() const;
    /// T / (T + B), the tyre's share of the energy to come; the default reference's share if nothing is left.
    [[nodiscard]] double required_share() const;
    /// Tyre share of the newest measured landing; NaN before the first.
    [[nodiscard]] double measured_share() const { return measured_share_; }
    /// Tyre share that a reference gives, as learnt so far.
    [[nodiscard]] double share_of(double reference) const { return share_per_slip_ * reference; }
    [[nodiscard]] double share_per_slip() const { return share_per_slip_; }
    /// Mean energy of a future landing: weighted mean of expectation, with the weight of kPriorLandings, and measured landings.
    [[nodiscard]] double landing_J() const;

    static constexpr double kPriorLandings = 20.0;
    /// Bounds of share_per_slip(). Eq. (9) gives 1 at constant slip; spin-up energy, build-up and the last metres move it a little.
    static constexpr double kMinSharePerSlip = 0.6, kMaxSharePerSlip = 1.6;

  private:
    [[nodiscard]] Reading judge(const Landing& landing) const;
    void learn(const Landing& landing);
    void guard(const Landing& landing);
    void estimate(const Landing& landing);
    void settle(double brake_wear_J);
    void move(double target, double from);

    WearPlan plan_;
    Rules rules_;
    Range range_;
    double reference_;
    int landings_ = 0;
    int missed_ = 0;
    Reading last_reading_ = Reading::missing;
    double brake_J_;
    double tyre_J_;
    double wear_counter_J_;         // newest brake_wear_J
    double guessed_brake_J_ = 0.0;  // for landings that were not measured, since then; part of brake_J_ and tyre_J_
    double guessed_tyre_J_ = 0.0;
    double measured_share_ = kUnknown;
    double share_per_slip_ = 1.0;
    double learnt_ = 0.0;  // landings that share_per_slip_ has seen
    double kinetic_J_ = 0.0;
    double kinetic_landings_ = 0.0;
};

}  // namespace wear
