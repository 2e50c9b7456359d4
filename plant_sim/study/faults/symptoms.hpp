/// Symptoms of a fault: figures of a stop computed only from the controller's inputs and commands. Without a fault they are near those of other
/// fault-free stops, on any runway.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "firmware/control/config.hpp"
#include "firmware/control/estimator.hpp"
#include "firmware/control/types.hpp"

namespace faults {

enum class Symptom : std::uint8_t {
    late,     ///< s, largest delay of a wheel frame after its newest edge, beyond the smallest so far
    refused,  ///< number of rejected frames of all inputs
    wild,     ///< number of impossible readings of the wheel above 2.7 times drop-out, decreasing by two per second; its maximum
    scatter,  ///< root mean square deviation of the wheel's readings from the expected speed, in standard deviations of a reading
    mass,     ///< kg, the aircraft's: impulse of the road (by brake torque and wheel acceleration) over the loss of speed
    off_map,  ///< Pa, mean deviation of the transducer's reading from the pressure that the commands alone explain
    lag,      ///< s, delay of the pressure behind the command, by regression on the commanded rate
    excess,   ///< s, integral of the slip beyond 0.05 above the reference in force; decreases below it
};
inline constexpr std::array<std::string_view, 8> kSymptomNames{"late_s", "refused", "wild", "scatter", "mass_kg", "off_map_Pa", "lag_s", "excess_s"};

/// Indexed by Symptom.
using Symptoms = std::array<double, kSymptomNames.size()>;

/// Computes the symptoms during a stop, with an estimator of its own.
class SymptomMeter {
  public:
    explicit SymptomMeter(const antiskid::control::Config& config) : config_(config), estimator_(config) {}

    /// Call after each step of the controller with its inputs and its command. `counts`: whether the fault has begun.
    void take(const antiskid::control::Sensors& sensors, const antiskid::control::Command& command, bool counts);
    [[nodiscard]] Symptoms symptoms() const;

  private:
    void take_wheel(const antiskid::control::Estimate& before);
    void take_pressure(const antiskid::control::Sensors& sensors, double model_before_Pa);

    antiskid::control::Config config_;
    antiskid::control::Estimator estimator_;
    float held_Pa_ = 0.0F;
    bool begun_ = false;
    std::uint32_t refused_before_ = 0;
    std::uint32_t refused_ = 0;
    double late_s_ = 0.0;
    double readings_ = 0.0, wild_ = 0.0, most_wild_ = 0.0, squares_ = 0.0;
    double impulse_Ns_ = 0.0, began_mps_ = 0.0, now_mps_ = 0.0;
    double periods_ = 0.0, off_Pa_ = 0.0, lag_up_ = 0.0, lag_down_ = 0.0;
    double excess_s_ = 0.0, most_excess_s_ = 0.0;
};

}  // namespace faults
