/// A small step of valve current on a rig at rest, and the response of the pressure: up to twice the residual pressure, held, and back. Pure: sensors
/// and time in, current out. A turning shaft, too much pressure, a silent sensor, an emergency stop or a lost link ends the step at the safe current.
#pragma once

#include <optional>
#include <string>

#include "firmware/control/config.hpp"
#include "firmware/control/types.hpp"
#include "firmware/controller/check.hpp"

namespace antiskid::controller {

class ValveStep {
  public:
    static constexpr control::Time kHold{500'000'000};
    static constexpr control::Time kRelease{500'000'000};  ///< longest time
    static constexpr double kTolerance = 0.25;             ///< allowed error, as share of the pressure by the valve map

    explicit ValveStep(const control::Config& config);

    /// The valve current for this period, mA. The first call begins the step.
    [[nodiscard]] float step(const control::Sensors& sensors, control::Time now);
    [[nodiscard]] bool over() const { return over_; }
    /// Ends the step, e.g. on the operator's request.
    void abort(std::string why);
    [[nodiscard]] Check result() const;

    [[nodiscard]] float current_mA() const { return current_mA_; }  ///< of the step
    [[nodiscard]] float target_Pa() const { return target_Pa_; }    ///< pressure by the valve map at this current

  private:
    [[nodiscard]] std::string alarm(const control::Sensors& sensors, control::Time now) const;
    void hold(float pressure_Pa, control::Time since);
    void release(float pressure_Pa, control::Time since);

    float safe_current_mA_;
    float target_Pa_;
    float current_mA_;
    control::Time answer_;  ///< limit of the time to half of the target, up and down
    control::Time max_age_;
    std::optional<control::Time> began_;
    std::optional<control::Time> released_;
    control::Sensors at_begin_;
    std::optional<control::Time> rise_;  ///< until half of the target
    std::optional<control::Time> fall_;
    double plateau_sum_Pa_ = 0.0;
    int plateau_count_ = 0;
    std::string aborted_;
    bool over_ = false;
};

}  // namespace antiskid::controller
