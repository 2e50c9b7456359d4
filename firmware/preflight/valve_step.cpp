#include "firmware/preflight/valve_step.hpp"

#include <fmt/core.h>

#include <chrono>
#include <cmath>

#include "firmware/control/valve_model.hpp"

namespace antiskid::preflight {

namespace {

constexpr control::Time kPlateau{100'000'000};  // of the hold, at its end

control::Time seconds(double s) {
    return std::chrono::round<control::Time>(std::chrono::duration<double>(s));
}

double ms(const std::optional<control::Time>& time) {
    return time ? std::chrono::duration<double, std::milli>(*time).count() : std::nan("");
}

bool moved(const control::SpeedInput& now, const control::SpeedInput& before) {
    constexpr float kStands_radps = 0.1F;
    return now.edge_count != before.edge_count || std::abs(now.speed_radps) > kStands_radps;
}

}  // namespace

ValveStep::ValveStep(const control::Config& config)
    : safe_current_mA_(config.valve.safe_current_mA),
      target_Pa_(2.0F * config.supervisor.residual_pressure_Pa),
      current_mA_(control::valve_current_mA(config.valve, target_Pa_)),
      // A second-order lag passes half after 1.7 / omega_n, behind the delay: a valve four times slower has its spool stuck in varnish.
      answer_(seconds(static_cast<double>(config.valve.delay_s) + 7.0 / static_cast<double>(config.valve.natural_frequency_radps))),
      most_age_(seconds(static_cast<double>(config.monitor.sensor_max_age_s))) {}

std::string ValveStep::alarm(const control::Sensors& sensors, control::Time now) const {
    if (sensors.emergency_stop) return "emergency stop";
    if (sensors.bus_off) return "the link is down";
    for (const control::Time received : {sensors.wheel.received, sensors.flywheel.received, sensors.pressure.received})
        if (received == control::kNever || now - received > most_age_) return "a sensor fell silent";
    if (moved(sensors.wheel, at_begin_.wheel)) return "the wheel turns";
    if (moved(sensors.flywheel, at_begin_.flywheel)) return "the flywheel turns";
    // Also false for a pressure that is no number.
    if (!(sensors.pressure.pressure_Pa <= 2.0F * target_Pa_))
        return fmt::format("{:.3f} MPa, twice what was asked", sensors.pressure.pressure_Pa * 1e-6F);
    return {};
}

void ValveStep::abort(std::string why) {
    if (over_) return;
    aborted_ = std::move(why);
    over_ = true;
}

float ValveStep::step(const control::Sensors& sensors, const control::Time now) {
    if (!began_) {
        began_ = now;
        at_begin_ = sensors;
    }
    if (std::string why = alarm(sensors, now); !why.empty()) abort(std::move(why));
    if (over_) return safe_current_mA_;
    const float pressure = sensors.pressure.pressure_Pa;
    if (!released_) {
        hold(pressure, now - *began_);
        if (now - *began_ >= kHold) released_ = now;
    } else {
        release(pressure, now - *released_);
    }
    return released_ ? safe_current_mA_ : current_mA_;
}

void ValveStep::hold(const float pressure_Pa, const control::Time since) {
    if (!rise_ && pressure_Pa >= 0.5F * target_Pa_) rise_ = since;
    if (since < kHold - kPlateau) return;
    plateau_sum_Pa_ += static_cast<double>(pressure_Pa);
    ++plateau_count_;
}

void ValveStep::release(const float pressure_Pa, const control::Time since) {
    if (pressure_Pa < 0.5F * target_Pa_) fall_ = since;
    over_ = fall_ || since >= kRelease;
}

Check ValveStep::result() const {
    const double target_MPa = 1e-6 * static_cast<double>(target_Pa_);
    const std::string required =
        fmt::format("{:.2f} MPa +- {:.0f} %, half of it within {:.0f} ms, up and down", target_MPa, 100.0 * kTolerance, ms(answer_));
    const std::string remedy = "hydraulics on? else docs/user/faults.md, pressure_off_command; [valve] of controller.toml";
    if (!aborted_.empty())
        return judged("valve step", false, {.measured = "ended at the safe current: " + aborted_, .required = required, .remedy = remedy});
    const double plateau_MPa = plateau_count_ > 0 ? 1e-6 * plateau_sum_Pa_ / plateau_count_ : 0.0;
    const bool good = std::abs(plateau_MPa - target_MPa) <= kTolerance * target_MPa && rise_ && *rise_ <= answer_ && fall_ && *fall_ <= answer_;
    Check check = judged(
        "valve step", good,
        {.measured = fmt::format("{:.2f} mA: {:.3f} MPa, up after {:.0f} ms, down after {:.0f} ms", current_mA_, plateau_MPa, ms(rise_), ms(fall_)),
         .required = required,
         .remedy = remedy});
    check.figures = {{"current_mA", static_cast<double>(current_mA_)}, {"pressure_MPa", plateau_MPa}};
    if (rise_) check.figures.emplace_back("rise_ms", ms(rise_));
    if (fall_) check.figures.emplace_back("fall_ms", ms(fall_));
    return check;
}

}  // namespace antiskid::preflight
