#include "plant_sim/study/validation/plant_validation.hpp"

#include <algorithm>
#include <cmath>

#include "plant_sim/study/validation/shaft_speed.hpp"
#include "plant_sim/study/validation/simulated_stop.hpp"
#include "rig_bridge/rig/tyre.hpp"

namespace validation {

namespace {

constexpr double kRow_s = 0.01;
constexpr double kStartWindow_s = 0.1;
constexpr double kGap_s = 0.02;

bool brakes(const antiskid::can::BusView& s) {
    return s.maneuver.arm && s.maneuver.demand_Pa > 0.0F;
}

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
    Validator(MeasuredSignals& signals, const rig::RigParameters& rig) : signals_(signals), rig_(rig), shafts_(rig) {}

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

    /// Up to brake-on; the speed there is that of the last whole window before it.
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

    MeasuredSignals& signals_;
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

Validation validate_plant(MeasuredSignals& signals, const rig::RigParameters& rig) {
    return Validator(signals, rig).run();
}

}  // namespace validation
