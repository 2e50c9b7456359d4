#include "plant_sim/study/faults/judge.hpp"

#include <algorithm>

namespace faults {

using antiskid::control::State;

void Judge::observe(const Observation& seen) {
    if (!begun_) begun_at_m_ = seen.distance_m;
    begun_ = true;
    now_m_ = seen.distance_m;
    passed_s_ += seen.period_s;
    named_.insert(seen.named);
    if (!seen.named.empty() && named_after_s_ < 0.0) named_after_s_ = passed_s_;
    fell_silent_ = fell_silent_ || !seen.received;
    permitted_ = permitted_ || (seen.state > State::standby && seen.state < State::safe);
    lock_protection_ = lock_protection_ || seen.state == State::locked_wheel;

    // Once the valve is commanded to release and the reason is named (a fault, or a failed self-test), the controller has no influence on the
    // hydraulics.
    const bool driver_safe = seen.driver_mA <= expected_.safe_mA;
    const bool given_up = (seen.state == State::safe || seen.state == State::self_test) && driver_safe;
    const double unasked_Pa = given_up ? 0.0 : seen.pressure_Pa - seen.asked_Pa;
    unasked_s_ = unasked_Pa > bounds_.unasked_Pa ? unasked_s_ + seen.period_s : 0.0;
    if (unasked_s_ > 0.0) max_uncommanded_Pa_ = std::max(max_uncommanded_Pa_, unasked_Pa);
    if (unasked_s_ > bounds_.unasked_s) raise(Hazard::unasked_pressure);

    const bool locked =
        !given_up && seen.slip > bounds_.lock_slip && seen.v_mps > bounds_.lock_above_mps && seen.pressure_Pa > bounds_.lock_pressure_Pa;
    lock_s_ = locked ? lock_s_ + seen.period_s : 0.0;
    longest_lock_s_ = std::max(longest_lock_s_, lock_s_);
    if (lock_s_ > bounds_.lock_s) raise(Hazard::locked_wheel);

    not_safe_yet_ = seen.state == State::safe && !driver_safe ? not_safe_yet_ + 1 : 0;
    if (not_safe_yet_ > bounds_.safe_within_periods) raise(Hazard::late_safe);

    const bool stopped = seen.state == State::safe && seen.named.contains(antiskid::control::Fault::emergency_stop);
    stop_heard_ = stop_heard_ || stopped;
    if (expected_.emergency_stop && !stop_heard_ && passed_s_ > bounds_.stop_within_s) raise(Hazard::stop_not_heard);
}

Judgement Judge::verdict(bool stood) const {
    Judgement v{.hazard = hazard_,
                .named = named_,
                .named_after_s = named_after_s_,
                .longest_lock_s = longest_lock_s_,
                .max_uncommanded_Pa = max_uncommanded_Pa_};
    const double sound_m = expected_.sound_distance_m - begun_at_m_;
    const double took_m = now_m_ - begun_at_m_;
    v.distance_share = sound_m > 0.0 ? took_m / sound_m : 1.0;
    const auto within = [&](double share) { return stood && took_m <= share * sound_m + bounds_.distance_slack_m; };
    const bool kept = expected_.changed_wish || within(bounds_.handled_share);
    // A controller that never gives permission reports that by its state, and no sequencer touches down then; a silent controller is named by its
    // listeners.
    const bool withheld = !permitted_ || fell_silent_;
    const bool degraded = lock_protection_ && within(bounds_.degraded_share);
    if (hazard_ == Hazard::none && named_.empty() && !kept && !withheld && !degraded) v.hazard = Hazard::silent_loss;
    if (v.hazard != Hazard::none)
        v.outcome = Outcome::unsafe;
    else if (!named_.empty())
        v.outcome = Outcome::safe;
    else if (kept)
        v.outcome = Outcome::handled;
    else
        v.outcome = withheld ? Outcome::safe : Outcome::degraded;
    return v;
}

}  // namespace faults
