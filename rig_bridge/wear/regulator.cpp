#include "rig_bridge/wear/regulator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace wear {

namespace {

void need(bool condition, const char* what) {
    if (!condition) throw std::invalid_argument(std::string("regulation: ") + what);
}

bool positive(double value) {
    return std::isfinite(value) && value > 0.0;
}

}  // namespace

const char* name(Reading reading) {
    static constexpr std::array kNames{"measured", "missing", "negative", "beyond_kinetic", "energy_mismatch", "counter_back"};
    return kNames[static_cast<std::size_t>(reading)];
}

Regulator::Regulator(const WearPlan& plan, const Rules& rules, const Range& range)
    : plan_(plan),
      rules_(rules),
      range_(range),
      reference_(rules.default_reference),
      brake_J_(plan.brake_taken_J),
      tyre_J_(plan.tyre_taken_J),
      wear_counter_J_(plan.brake_taken_J) {
    need(plan.landings > 0, "landings must be above 0");
    need(positive(plan.brake_life_J) && positive(plan.tyre_life_J), "a life must be above 0 J");
    need(plan.brake_taken_J >= 0.0 && plan.brake_taken_J < plan.brake_life_J, "the energy that the brake has taken must be from 0 to below its life");
    need(plan.tyre_taken_J >= 0.0 && plan.tyre_taken_J < plan.tyre_life_J, "the energy that the tyre has taken must be from 0 to below its life");
    need(positive(plan.landing_J), "the energy of a landing must be above 0 J");
    need(std::isfinite(plan.landing_deviation_J) && plan.landing_deviation_J >= 0.0, "the deviation of a landing's energy must not be negative");
    need(plan.tolerance > 0.0 && plan.tolerance < 1.0, "the tolerance must be between 0 and 1");
    need(rules.step > 0.0 && rules.step <= 0.5, "the step must be above 0 and at most 0.5");
    need(rules.max_unmeasured_landings >= 0, "the greatest number of unmeasured landings must not be negative");
    need(rules.energy_tolerance > 0.0 && rules.energy_tolerance < 1.0, "the energy tolerance must be between 0 and 1");
    need(rules.adaptation > 0.0 && rules.adaptation <= 1.0, "the adaptation must be above 0 and at most 1");
    need(range.lowest > 0.0 && range.highest <= 0.5, "references must lie above 0 and not above 0.5");
    need(range.contains(rules.default_reference), "the default reference lies outside of the range");
}

double Regulator::brake_left_J() const {
    return std::max(plan_.brake_life_J - brake_J_, 0.0);
}

double Regulator::tyre_left_J() const {
    return std::max(plan_.tyre_life_J - tyre_J_, 0.0);
}

double Regulator::required_share() const {
    const double left = brake_left_J() + tyre_left_J();
    return left > 0.0 ? tyre_left_J() / left : share_of(rules_.default_reference);
}

double Regulator::landing_J() const {
    return (plan_.landing_J * kPriorLandings + kinetic_J_) / (kPriorLandings + kinetic_landings_);
}

Reading Regulator::judge(const Landing& l) const {
    for (const double value : {l.reference, l.kinetic_J, l.brake_J, l.tyre_J}) {
        if (!std::isfinite(value)) return Reading::missing;
        if (value < 0.0) return Reading::negative;
    }
    if (l.reference == 0.0 || l.kinetic_J == 0.0) return Reading::missing;
    const double max_J = l.kinetic_J * (1.0 + rules_.energy_tolerance);
    if (l.tyre_J > max_J || l.brake_J > max_J) return Reading::beyond_kinetic;
    if (std::abs(l.brake_J + l.tyre_J - l.kinetic_J) > rules_.energy_tolerance * l.kinetic_J) return Reading::energy_mismatch;
    if (l.brake_wear_J < wear_counter_J_) return Reading::counter_back;
    return Reading::measured;
}

void Regulator::learn(const Landing& l) {
    measured_share_ = l.tyre_J / (l.tyre_J + l.brake_J);
    learnt_ += 1.0;
    constexpr double kTrustInOne = 4.0;  // weight of the first guess, eq. (9) at constant slip, in landings
    const double gain = std::max(1.0 / (learnt_ + kTrustInOne), rules_.adaptation);
    const double seen = measured_share_ / (l.expected_share > 0.0 ? l.expected_share : l.reference);
    share_per_slip_ = std::clamp(share_per_slip_ + gain * (seen - share_per_slip_), kMinSharePerSlip, kMaxSharePerSlip);
    kinetic_J_ += l.kinetic_J;
    kinetic_landings_ += 1.0;
}

/// The table may be wrong for this runway: a measurement below the floor moves the bound on that side.
void Regulator::guard(const Landing& l) {
    if (!(l.j_mu > 0.0 && l.j_mu < rules_.j_mu_floor)) return;
    const double middle = rules_.default_reference;
    if (l.reference > middle)
        range_.highest = std::max(middle, std::min(range_.highest, l.reference - rules_.step));
    else if (l.reference < middle)
        range_.lowest = std::min(middle, std::max(range_.lowest, l.reference + rules_.step));
}

/// A landing without measurement wears, too.
void Regulator::estimate(const Landing& l) {
    const double max_J = plan_.landing_J + 10.0 * plan_.landing_deviation_J;
    const bool known = l.kinetic_J > 0.0 && l.kinetic_J <= max_J;
    const double energy_J = known ? l.kinetic_J : landing_J();
    const double share = std::min(share_of(reference_), 1.0);
    tyre_J_ += share * energy_J;
    brake_J_ += (1.0 - share) * energy_J;
    guessed_tyre_J_ += share * energy_J;
    guessed_brake_J_ += (1.0 - share) * energy_J;
}

/// The brake's cumulative energy determines the energy of the landings in between; the tyre's is in proportion.
void Regulator::settle(double brake_wear_J) {
    if (guessed_brake_J_ > 0.0) {
        const double took_J = brake_wear_J - (brake_J_ - guessed_brake_J_);
        tyre_J_ += guessed_tyre_J_ * (std::max(took_J, 0.0) / guessed_brake_J_ - 1.0);
    }
    brake_J_ = wear_counter_J_ = brake_wear_J;
    guessed_brake_J_ = guessed_tyre_J_ = 0.0;
}

void Regulator::move(double target, double from) {
    const double stepped = std::clamp(target, from - rules_.step, from + rules_.step);
    reference_ = std::clamp(stepped, range_.lowest, range_.highest);
}

Reading Regulator::after(const Landing& landing) {
    ++landings_;
    last_reading_ = judge(landing);
    if (last_reading_ != Reading::measured) {
        ++missed_;
        estimate(landing);
        move(missed_ >= rules_.max_unmeasured_landings ? rules_.default_reference : reference_, reference_);
        return last_reading_;
    }
    missed_ = 0;
    tyre_J_ += landing.tyre_J;
    brake_J_ += landing.brake_J;
    if (std::isfinite(landing.brake_wear_J)) settle(landing.brake_wear_J);
    learn(landing);
    guard(landing);
    move(required_share() / share_per_slip_, landing.reference);
    return last_reading_;
}

void Regulator::spent(double brake_J, double tyre_J) {
    if (std::isfinite(brake_J) && brake_J > 0.0) brake_J_ += brake_J;
    if (std::isfinite(tyre_J) && tyre_J > 0.0) tyre_J_ += tyre_J;
}

bool Regulator::revise_brake_life(double life_J) {
    if (!positive(life_J)) return false;
    plan_.brake_life_J = life_J;
    return true;
}

bool Regulator::revise_tyre_life(double life_J) {
    if (!positive(life_J)) return false;
    plan_.tyre_life_J = life_J;
    return true;
}

void Regulator::narrow(const Range& range) {
    need(range.contains(rules_.default_reference), "the default reference lies outside of the range");
    range_ = range_.within(range);
    reference_ = std::clamp(reference_, range_.lowest, range_.highest);
}

}  // namespace wear
