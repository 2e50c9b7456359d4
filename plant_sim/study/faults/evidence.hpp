/// What the controller's inputs show of a stop, whatever is true: figures that a sound rig keeps near those of its sound stops, on any runway.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "firmware/control/config.hpp"
#include "firmware/control/estimator.hpp"
#include "firmware/control/types.hpp"

namespace faults {

enum class Sign : std::uint8_t {
    late,     ///< s, the latest wheel frame against its own edges
    refused,  ///< frames of any input
    wild,     ///< the most at once of the wheel's readings that no wheel can have got to, two forgotten a second, above 2.7 times drop-out
    scatter,  ///< root mean square of what the wheel's readings are off the speed that was expected, in standard deviations of a reading
    mass,     ///< kg, the aircraft's by the impulse of the road (brake's torque and wheel's acceleration) over the speed that it lost
    off_map,  ///< Pa, mean distance of the transducer's reading from what the commands alone explain
    lag,      ///< s, by which the pressure comes later than commanded, by regression on the rate commanded
    excess,   ///< s, slip beyond 0.05 above the reference in force, added up; below it pays back
};
inline constexpr std::array<std::string_view, 8> kSignNames{"late_s", "refused", "wild", "scatter", "mass_kg", "off_map_Pa", "lag_s", "excess_s"};
[[nodiscard]] constexpr std::string_view name(Sign sign) {
    return kSignNames[static_cast<std::size_t>(sign)];
}

/// By Sign.
using Signs = std::array<double, kSignNames.size()>;

/// Follows a stop by what the controller is given, with an estimator of its own.
class Witness {
  public:
    explicit Witness(const antiskid::control::Config& config) : config_(config), estimator_(config) {}

    /// After each step of the controller, with what it was given and its answer. Counts where `counts`.
    void take(const antiskid::control::Sensors& sensors, const antiskid::control::Command& command, bool counts);
    [[nodiscard]] Signs signs() const;

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
