/// The controller's picture of the valve: its static map both ways, the pressure now and the pressure that is
/// already on its way.
#pragma once

#include <array>
#include <cstddef>

#include "firmware/control/config.hpp"

namespace antiskid::control {

/// Inverse of the static map, linear between points: the current for a pressure. No pressure asks for no
/// current: the dead zone is jumped.
[[nodiscard]] float valve_current_mA(const ValveConfig& valve, float pressure_Pa);
/// The static map.
[[nodiscard]] float valve_pressure_Pa(const ValveConfig& valve, float current_mA);

struct PressureState {
    float pressure_Pa = 0.0F;
    float rate_Paps = 0.0F;
};

/// Observer of eq. (6): second-order lag behind a transport delay, corrected by the measured pressure, and of the offset by which the
/// valve's static pressure differs from its map.
class ValveModel {
  public:
    static constexpr std::size_t kMaxDelay = 16;  ///< periods

    ValveModel(const ValveConfig& valve, float period_s, const EstimatorConfig& estimator);

    /// One period has passed, in which the valve held `command_Pa` (static pressure of the last current);
    /// `measured_Pa` is the newest reading, used where `fresh`.
    void update(float command_Pa, float measured_Pa, bool fresh);

    [[nodiscard]] const PressureState& now() const { return state_; }
    /// The pressure that the commands alone explain, never corrected, without an offset: what a healthy valve would show.
    [[nodiscard]] float uncorrected_Pa() const { return uncorrected_.pressure_Pa; }
    /// Of the valve from its map, as learnt.
    [[nodiscard]] float offset_Pa() const { return offset_Pa_; }

    /// What to ask of the map so that `pressure_Pa` comes out.
    [[nodiscard]] float compensated_Pa(float pressure_Pa) const;

    /// One period on from `from`, which is `periods_ahead` - 1 from now, by commands that are already in the pipe; 1 to delay_periods().
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
    /// The static pressure that drives the lag `periods_ahead` periods from the newest command on its way out of the pipe.
    [[nodiscard]] float input(std::size_t periods_ahead) const { return inputs_[(newest_ + periods_ahead - whole_) % kKept]; }

    static constexpr std::size_t kKept = 32;  // a power of two above kMaxDelay + 1
    std::array<float, kKept> inputs_{};       // a ring; of commands a part of a period apart, where the delay is no whole one
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
