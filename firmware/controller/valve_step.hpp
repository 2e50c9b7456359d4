/// A small step of valve current on a rig at rest, and the pressure's answer to it: up to twice the residual pressure, held, and back.
/// Pure: sensors and time in, current out. Whatever turns, presses too hard or falls silent on the way ends it at the safe current.
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
    static constexpr control::Time kRelease{500'000'000};  ///< at the most
    static constexpr double kTolerance = 0.25;             ///< of the pressure that the map promises

    explicit ValveStep(const control::Config& config);

    /// The current for this period, mA. The first call begins the step.
    [[nodiscard]] float step(const control::Sensors& sensors, control::Time now);
    [[nodiscard]] bool over() const { return over_; }
    /// Ends it from outside, e.g. the operator.
    void abort(std::string why);
    [[nodiscard]] Check result() const;

    [[nodiscard]] float current_mA() const { return current_mA_; }  ///< of the step
    [[nodiscard]] float target_Pa() const { return target_Pa_; }    ///< that the map promises for it

  private:
    [[nodiscard]] std::string alarm(const control::Sensors& sensors, control::Time now) const;
    void hold(float pressure_Pa, control::Time since);
    void release(float pressure_Pa, control::Time since);

    float safe_current_mA_;
    float target_Pa_;
    float current_mA_;
    control::Time answer_;  ///< within which half of the target is passed, up and down
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
