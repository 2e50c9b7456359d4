#include "plant_sim/study/validation/plant_validation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <numbers>
#include <optional>

#include "plant_sim/model/rig.hpp"
#include "rig_bridge/record/edge_track.hpp"
#include "rig_bridge/rig/tyre.hpp"

namespace validation {

namespace {

constexpr double kStep_s = 1e-3;
constexpr std::size_t kRemembered = 2000;  // steps

plant::Rig rolling(rig::RigParameters parameters, double speed_mps) {
    const double nominal_mps = parameters.brake_on_mps;
    parameters.brake_on_mps = speed_mps;
    plant::Rig rig(parameters, kStep_s, 0);
    rig.start_rolling();
    rig.set_brake(parameters.mean_friction, nominal_mps);
    return rig;
}

/// A stop of the plant with prescribed pressure; its states are kept as long as a window between two encoder edges may last.
class SimulatedStop {
  public:
    /// Starts at `start_s` with the wheel rolling freely at `speed_mps` under `pressure_Pa`. The brake's friction curve is that of the parameters'
    /// brake-on speed.
    SimulatedStop(const rig::RigParameters& parameters, double speed_mps, double start_s, double pressure_Pa)
        : rig_(rolling(parameters, speed_mps)), start_s_(start_s), given_s_(start_s), given_Pa_(pressure_Pa), pressure_Pa_(pressure_Pa) {
        rig_.start_pressure(pressure_Pa);
        remember();
    }

    /// Advances to the last whole millisecond since the start that is not after `time_s`; the pressure changes linearly to `pressure_Pa` at `time_s`.
    /// Times must not decrease.
    void advance(double time_s, double pressure_Pa) {
        constexpr double kRounding_s = 1e-9;
        while (!rig_.standstill() && newest_s() + kStep_s <= time_s + kRounding_s) {
            const double share = time_s > given_s_ ? (newest_s() + kStep_s - given_s_) / (time_s - given_s_) : 1.0;
            const double next_Pa = given_Pa_ + std::clamp(share, 0.0, 1.0) * (pressure_Pa - given_Pa_);
            rig_.advance_pressure(pressure_Pa_, next_Pa);
            pressure_Pa_ = next_Pa;
            ++steps_;
            remember();
        }
        given_s_ = time_s;
        given_Pa_ = pressure_Pa;
    }

    [[nodiscard]] bool standstill() const { return rig_.standstill(); }

    /// Means over a window; over one instant where `to_s` is `from_s`.
    struct Motion {
        double v_mps, omega_radps, radius_m;
    };
    /// None: the window is outside of the kept two seconds, or begins before the start.
    [[nodiscard]] std::optional<Motion> mean(double from_s, double to_s) const {
        constexpr double kInstant_s = 1e-6;
        const auto a = at(from_s);
        const auto b = at(to_s);
        if (!a || !b) return std::nullopt;
        const double length = to_s - from_s;
        if (length < kInstant_s) return Motion{b->v_mps, b->omega_radps, b->radius_m};
        return Motion{(b->distance_m - a->distance_m) / length, (b->angle_rad - a->angle_rad) / length, 0.5 * (a->radius_m + b->radius_m)};
    }

  private:
    struct Instant {
        double distance_m, angle_rad, v_mps, omega_radps, radius_m;
    };
    void remember() {
        const plant::WheelState& w = rig_.wheel();
        past_.push_back({w.distance_m, w.angle_rad, w.v_mps, w.omega_radps, rig_.forces().radius_m});
        if (past_.size() > kRemembered) past_.pop_front();
    }
    [[nodiscard]] double newest_s() const { return start_s_ + static_cast<double>(steps_) * kStep_s; }
    [[nodiscard]] std::optional<Instant> at(double time_s) const {
        const double index = static_cast<double>(past_.size() - 1) - (newest_s() - time_s) / kStep_s;
        if (index < 0.0) return std::nullopt;
        const auto i = static_cast<std::size_t>(index);
        if (i + 1 >= past_.size()) return past_.back();
        const double x = index - static_cast<double>(i);
        const Instant& a = past_[i];
        const Instant& b = past_[i + 1];
        const auto between = [x](double p, double q) { return p + x * (q - p); };
        return Instant{between(a.distance_m, b.distance_m), between(a.angle_rad, b.angle_rad), between(a.v_mps, b.v_mps),
                       between(a.omega_radps, b.omega_radps), between(a.radius_m, b.radius_m)};
    }

    plant::Rig rig_;
    double start_s_;
    double given_s_, given_Pa_;  // the newest prescribed pressure
    double pressure_Pa_;         // at the end of the last step
    std::int64_t steps_ = 0;
    std::deque<Instant> past_;
};

constexpr double kRow_s = 0.01;
constexpr double kStartWindow_s = 0.1;
constexpr double kGap_s = 0.02;

bool brakes(const antiskid::can::BusView& s) {
    return s.maneuver.arm && s.maneuver.demand_Pa > 0.0F;
}

/// Mean speed of a shaft over a window between two of its edges, the same for both sides, so that the lag of a speed estimate does not matter.
class ShaftSpeed {
  public:
    struct Window {
        double from_s, to_s;  ///< log time; equal where the sensor reports speed itself
        double speed_radps;   ///< mean between them
    };

    explicit ShaftSpeed(double teeth) : track_(2.0 * std::numbers::pi / teeth) {}

    /// Call after every sample, at its log time.
    void see(const antiskid::control::SpeedInput& input, double time_s) {
        if (input.received == antiskid::control::kNever) return;
        reported_.reset();
        if (input.source == antiskid::control::SpeedSource::speed)
            reported_ = {time_s, time_s, static_cast<double>(input.speed_radps)};
        else
            track_.update(input.edge_count, input.edge_time, time_s);
        if (track_.edge_updates() == 1) restart();
    }

    /// Window from the end of the previous one to the newest edge; none: no new edge.
    [[nodiscard]] std::optional<Window> take() {
        if (reported_) return reported_;
        const double length_s = track_.stamp_s() - from_stamp_s_;
        if (!(length_s > 0.0)) return std::nullopt;
        const double to_s = track_.last_edge_s();
        const Window window{to_s - length_s, to_s, (track_.way_at_edge() - from_rad_) / length_s};
        restart();
        return window;
    }

  private:
    void restart() {
        from_stamp_s_ = track_.stamp_s();
        from_rad_ = track_.way_at_edge();
    }

    rig::record::EdgeTrack track_;
    std::optional<Window> reported_;
    double from_stamp_s_ = 0.0, from_rad_ = 0.0;
};

/// Both encoders of a rig.
struct Shafts {
    explicit Shafts(const rig::RigParameters& rig)
        : wheel(rig.wheel_encoder.teeth), flywheel(rig.flywheel_encoder.teeth), R_f_m(rig.flywheel_radius_m) {}

    void see(const antiskid::can::BusView& s, double time_s) {
        wheel.see(s.wheel, time_s);
        flywheel.see(s.flywheel, time_s);
    }

    ShaftSpeed wheel, flywheel;
    double R_f_m;
};

class Validator {
  public:
    Validator(rig::replay::MeasuredSignals& signals, const rig::RigParameters& rig) : signals_(signals), rig_(rig), shafts_(rig) {}

    Validation run() {
        if (!roll()) return result_;
        result_.peak_slip = rig::peak(rig_.surface).slip;
        SimulatedStop stop(rig_, result_.brake_on_mps, signals_.time_s(), pressure_Pa());
        result_.ended = brake(stop);
        result_.end_s = last_s_ - result_.brake_on_s;
        finish();
        return result_;
    }

  private:
    [[nodiscard]] double pressure_Pa() const { return static_cast<double>(signals_.view().pressure.pressure_Pa); }

    /// Advances to brake-on; the speed there is that of the last whole window before it.
    bool roll() {
        double window_end_s = 0.0;
        while (signals_.next()) {
            last_s_ = signals_.time_s();
            shafts_.see(signals_.view(), last_s_);
            if (brakes(signals_.view()) && result_.brake_on_mps > 0.0) {
                result_.braked = true;
                result_.brake_on_s = last_s_;
                result_.brake_on_line = signals_.line();
                result_.lockstep = signals_.lockstep();
                (void)shafts_.wheel.take();
                (void)shafts_.flywheel.take();
                return true;
            }
            if (last_s_ - window_end_s < kStartWindow_s) continue;
            window_end_s = last_s_;
            (void)shafts_.wheel.take();
            if (const auto window = shafts_.flywheel.take()) result_.brake_on_mps = window->speed_radps * shafts_.R_f_m;
        }
        return false;
    }

    std::string brake(SimulatedStop& stop) {
        double next_row_s = last_s_ + kRow_s;
        while (signals_.next()) {
            const double now_s = signals_.time_s();
            const double gap_s = now_s - last_s_;
            if (gap_s > kGap_s) {
                ++result_.gaps;
                result_.longest_gap_s = std::max(result_.longest_gap_s, gap_s);
            }
            last_s_ = now_s;
            shafts_.see(signals_.view(), now_s);
            stop.advance(now_s, pressure_Pa());
            if (!brakes(signals_.view())) return "the demand was taken back";
            if (now_s + 1e-9 >= next_row_s) {
                row(stop, now_s);
                next_row_s = now_s + kRow_s;
            }
            if (stop.standstill()) return "standstill of the simulation";
        }
        return signals_.restarted() ? "SYNC numbers start again: another recording" : "the log ends";
    }

    void row(const SimulatedStop& stop, double now_s) {
        const auto flywheel = shafts_.flywheel.take();
        const auto wheel = shafts_.wheel.take();
        if (!flywheel) return;
        const auto v_sim = stop.mean(flywheel->from_s, flywheel->to_s);
        if (!v_sim) return;
        ValidationRow row{.time_s = now_s - result_.brake_on_s,
                          .speed_mps = flywheel->speed_radps * shafts_.R_f_m,
                          .simulated_speed_mps = v_sim->v_mps,
                          .wheel_rim_mps = {},
                          .simulated_wheel_rim_mps = {},
                          .slip = {},
                          .simulated_slip = {},
                          .pressure_Pa = pressure_Pa()};
        const auto omega_sim = wheel ? stop.mean(wheel->from_s, wheel->to_s) : std::nullopt;
        if (omega_sim) {
            row.wheel_rim_mps = wheel->speed_radps * omega_sim->radius_m;
            row.simulated_wheel_rim_mps = omega_sim->omega_radps * omega_sim->radius_m;
            row.slip = 1.0 - *row.wheel_rim_mps / row.speed_mps;
            row.simulated_slip = 1.0 - *row.simulated_wheel_rim_mps / row.simulated_speed_mps;
        }
        add(row);
    }

    void add(const ValidationRow& row) {
        const auto band = static_cast<std::size_t>(std::max(row.speed_mps, 0.0) / Validation::kBand_mps);
        if (band >= result_.bands.size()) result_.bands.resize(band + 1);
        for (ValidationErrors* errors : {&result_.bands[band], &result_.all}) {
            errors->speed_mps.add(row.simulated_speed_mps - row.speed_mps);
            if (!row.slip) continue;
            errors->wheel_rim_mps.add(*row.simulated_wheel_rim_mps - *row.wheel_rim_mps);
            errors->slip.add(*row.simulated_slip - *row.slip);
        }
        result_.rows.push_back(row);
    }

    void finish() {
        result_.rejected = signals_.rejected();
        std::uint64_t beyond = 0;
        for (const ValidationRow& row : result_.rows) beyond += row.slip && *row.slip > result_.peak_slip ? 1U : 0U;
        if (!result_.rows.empty()) result_.past_peak = static_cast<double>(beyond) / static_cast<double>(result_.rows.size());
    }

    rig::replay::MeasuredSignals& signals_;
    const rig::RigParameters& rig_;
    Shafts shafts_;
    double last_s_ = 0.0;
    Validation result_;
};

}  // namespace

void ErrorFigures::add(double error) {
    ++count;
    sum_of_squares += error * error;
    largest = std::max(largest, std::abs(error));
}

double ErrorFigures::rms() const {
    return count == 0 ? 0.0 : std::sqrt(sum_of_squares / static_cast<double>(count));
}

Validation validate_plant(rig::replay::MeasuredSignals& signals, const rig::RigParameters& rig) {
    return Validator(signals, rig).run();
}

}  // namespace validation
