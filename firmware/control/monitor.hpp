/// Checks every input in every period and names the faults. Braking is permitted only without faults.
///
/// Each signal has two fault counters. One counts impossible readings: out of the sensor's range, or not reachable from the previous readings. The
/// other counts periods in which the estimate from the readings is implausible. The conditions may be interrupted: each good reading or period takes
/// back half of a bad one.
///
/// - *_lost: no accepted frame for the input's maximum age, or a reading later than half of it
/// - *_corrupt: as *_lost, but frames arrived and were refused; or the refused frames exceed the accepted ones by more than the maximum age has
///   periods (maneuver command, with rarer frames: than it has halves of a sensor's maximum age)
/// - *_range: a reading outside the sensor's range, or not a number
/// - *_rate: a reading that differs from the previous one by more than is physically possible; or an armed aircraft on its wheels that gained more,
///   by `overspeed_share`, than it can lose by braking
/// - wheel_stuck, speeds_disagree: a rolling wheel that lost more speed, by `overspeed_share`, than twice the brake's torque, k_b P / J_w, takes;
///   stuck where no edge says so
/// - flywheel_stuck: an aircraft that lost more, by `overspeed_share`, than it can by braking
///
/// In `implausible_s` of readings, each counted as one period. In `stuck_s` of periods:
/// - wheel_stuck: no edge although the brake is released and the aircraft moves
/// - flywheel_stuck: no edge although the wheel turns
/// - speeds_disagree: wheel faster than the aircraft by `overspeed_share`; or steady slip above `free_slip` of a wheel that turns under hardly
///   any pressure
///
/// In `off_command_s` of periods:
/// - pressure_stuck: the same reading to the last bit while the model moved by `pressure_moves_Pa`
/// - pressure_off_command: reading against uncorrected valve model differs by `off_command_Pa`, or by the residual pressure of the self-test
///   where the model has none, armed or with load on the wheel; or the learnt offset of the valve is more than the law may make up for
///
/// And:
/// - speeds_disagree: slip, at its lowest of late, above the slip law's reference, integrated over time
/// - maneuver_range: a commanded value outside its range, at once
/// - heartbeat_lost, emergency_stop, bus_off: at once after the age or event
/// - overrun: more than `overruns` missed periods in quick succession; ten good periods offset a missed one
#pragma once

#include "firmware/control/config.hpp"
#include "firmware/control/estimator.hpp"
#include "firmware/control/persistence.hpp"
#include "firmware/control/types.hpp"

namespace antiskid::control {

class Monitor {
  public:
    /// The controller's state in the previous period.
    struct PreviousStep {
        bool rolling;  ///< on the wheels and spun up since touchdown
        bool braking;  ///< a law acted
        float slip_reference;
    };

    explicit Monitor(const Config& config);

    /// Faults present in this period. `estimator` has already seen the same inputs.
    [[nodiscard]] FaultSet check(const Sensors& sensors, const Estimator& estimator, const PreviousStep& previous, Time now);

  private:
    /// Age and refusals of one input.
    struct Arrival {
        Arrival(float max_age_s, float frame_period_s);
        Time max_age;
        float max_reject_score;
        Time received = kNever;
        std::uint32_t rejected = 0;
        std::uint32_t rejected_before = 0;
        float reject_score = 0.0F;  // refused minus accepted frames, not below 0
        enum class MessageState : std::uint8_t { good, lost, corrupt };
        MessageState judge(Time newest, std::uint32_t rejected_now, Time now);
    };
    /// One speed.
    struct Speed {
        Speed(const MonitorConfig& config, float period_s) : reading(config.implausible_s, period_s), stays(config.stuck_s, period_s) {}
        FaultCounter reading;
        FaultCounter stays;
        float min = 0.0F;  // that it must still have: the wheel in rad/s, the aircraft in m/s
        float last_radps = 0.0F;
        bool known = false;
    };
    /// Names of the faults of one speed.
    struct SpeedNames {
        Fault lost, range, rate;
    };

    void check_arrivals(FaultSet& faults, const Sensors& sensors, Time now);
    void check_wheel(FaultSet& faults, const Estimator& estimator, const PreviousStep& previous);
    void check_flywheel(FaultSet& faults, const Estimator& estimator, bool lands);
    void check_pressure(FaultSet& faults, const Sensors& sensors, const Estimator& estimator, const PreviousStep& previous);
    void check_slip(FaultSet& faults, const ManeuverInput& maneuver, const Estimator& estimator, const PreviousStep& previous);
    void check_maneuver(FaultSet& faults, const ManeuverInput& maneuver) const;
    void check_overrun(FaultSet& faults, std::uint32_t missed_periods);
    /// Faults of a fresh reading by itself and compared with the previous one.
    [[nodiscard]] FaultSet wrong_by_itself(Speed& speed, const SpeedReading& reading, const EncoderConfig& encoder, const SpeedNames& names) const;

    MonitorConfig config_;
    EncoderConfig wheel_encoder_;
    EncoderConfig flywheel_encoder_;
    float flywheel_radius_m_;
    float hardest_brake_;
    float released_Pa_;
    float period_s_;
    float acted_keeps_;      // of acted_radps2_, after a period
    float slower_, faster_;  // a speed over another one beyond which they disagree
    float compensated_share_;
    Arrival wheel_arrival_, flywheel_arrival_, pressure_arrival_, maneuver_arrival_;
    float latest_s_;
    Time heartbeat_max_age_;
    Speed wheel_;
    Persistence wheel_hurries_;  // without a break: a carcass swings
    Speed flywheel_;
    float max_mps_ = 0.0F;       // that an aircraft on its wheels can have
    float acted_radps2_ = 0.0F;  // by brake or road, with what is left of it in a carcass
    FaultCounter pressure_reading_, pressure_stays_;
    float last_reading_Pa_ = 0.0F;
    Time last_reading_at_ = kNever;
    float model_at_change_Pa_ = 0.0F;
    float held_slip_ = 0.0F;  // the lowest of late, forgotten over `stuck_s`
    float excess_slip_s_ = 0.0F;
    std::uint32_t overrun_score_ = 0;
};

}  // namespace antiskid::control
