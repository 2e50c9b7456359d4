/// The controller's model of the valve: static map and its inverse, present pressure, and the pressure predicted from commands already given.
#pragma once

#include <array>
#include <cstddef>

#include "firmware/control/config.hpp"

namespace antiskid::control {

/// Inverse of the static map, linear between points: the current for a pressure. Zero pressure gives the safe current; the dead zone is skipped.
[[nodiscard]] float valve_current_mA(const ValveConfig& valve, float pressure_Pa);
/// The static map.
[[nodiscard]] float valve_pressure_Pa(const ValveConfig& valve, float current_mA);

struct PressureState {
    float pressure_Pa = 0.0F;
    float rate_Paps = 0.0F;
};

/// Observer of eq. (6): second-order lag behind a transport delay, corrected by the measured pressure. Also estimates the offset of the valve's
/// static pressure from its map.
class ValveModel {
  public:
    static constexpr std::size_t kMaxDelay = 16;  ///< periods

    ValveModel(const ValveConfig& valve, float period_s, const EstimatorConfig& estimator);

    /// One period has passed, in which the valve held `command_Pa` (static pressure of the last current);
    /// `measured_Pa` is the newest reading, used if `fresh`.
    void update(float command_Pa, float measured_Pa, bool fresh);

    [[nodiscard]] const PressureState& now() const { return state_; }
    /// Pressure of a healthy valve under these commands: neither corrected by measurement nor offset.
    [[nodiscard]] float uncorrected_Pa() const { return uncorrected_.pressure_Pa; }
    /// Learnt offset of the valve from its map.
    [[nodiscard]] float offset_Pa() const { return offset_Pa_; }

    /// Pressure to look up in the map so that the valve gives `pressure_Pa`.
    [[nodiscard]] float compensated_Pa(float pressure_Pa) const;

    /// State `periods_ahead` periods from now, by commands already given, where `from` is the state one period earlier; 1 to delay_periods().
    [[nodiscard]] PressureState after(PressureState from, std::size_t periods_ahead) const {
        propagate(from, input(periods_ahead) + offset_Pa_);
        return from;
    }
    [[nodiscard]] std::size_t delay_periods() const { return whole_; }
    [[nodiscard]] float delay_s() const { return delay_s_; }

  private:
    void propagate(PressureState& state, float input) const {
        // Unit static gain: a constant input u keeps the state (u, 0).
        const float ahead = input - state.pressure_Pa;
        state.pressure_Pa += a12_ * state.rate_Paps + b1_ * ahead;
        state.rate_Paps = a22_ * state.rate_Paps + b2_ * ahead;
    }
    /// Static pressure at the output of the delay, `periods_ahead` periods from now.
    [[nodiscard]] float input(std::size_t periods_ahead) const { return inputs_[(newest_ + periods_ahead - whole_) % kKept]; }

    static constexpr std::size_t kKept = 32;  // a power of two above kMaxDelay + 1
    std::array<float, kKept> inputs_{};       // a ring; interpolated between commands if the delay is not a whole number of periods
    float newest_command_Pa_ = 0.0F;
    std::size_t newest_ = 0;
    std::size_t whole_ = 0;  // whole periods of delay
    float part_ = 0.0F;      // and the rest, in periods
    float delay_s_ = 0.0F;
    float a12_ = 0.0F, a22_ = 0.0F, b1_ = 0.0F, b2_ = 0.0F;
    float correct_pressure_, correct_rate_, correct_offset_;
    float offset_share_, max_offset_Pa_, max_innovation_Pa_;
    float offset_Pa_ = 0.0F;
    PressureState state_;
    PressureState uncorrected_;
};

}  // namespace antiskid::control
