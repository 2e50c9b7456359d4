/// Checks every input in every period and names what is wrong. Permission to brake is the absence of faults.
///
/// - *_lost: no accepted frame for the input's maximum age; or, of a speed, its frames come more than 25 ms later after the edges that they
///   show than the quickest ones, in as many fresh readings as periods in `implausible_s`, also on and off
/// - *_corrupt: the same, while frames came and were refused; or more frames were refused, beyond those that were accepted, than the
///   maximum age has periods; of the maneuver command, whose frames are rarer, than it has times 10 ms
/// - *_range: outside what the sensor can mean (or not a number), in as many fresh readings as periods in `implausible_s`, also on and off
/// - *_rate: fresh readings change faster than the machine can, as many of them as periods in `implausible_s`, also on and off
/// - wheel_stuck: no edge although the brake is released and the aircraft moves, for `stuck_s`
/// - flywheel_stuck: the speed is below that of an aircraft that brakes twice as hard as a tyre can, by `overspeed_share` of it, for
///   `implausible_s`; or no edge although the wheel turns, for `stuck_s`
/// - flywheel_rate: as above; or, armed and on its wheels, the aircraft gets faster, by `overspeed_share`, for `implausible_s`
/// - pressure_stuck: the same reading to the last bit while the model moved by `pressure_moves_Pa`, for `stuck_s`
/// - speeds_disagree: wheel faster than the aircraft by `overspeed_share`, or steady slip above `free_slip` of a wheel that turns
///   under hardly any pressure, for `stuck_s`, also on and off; or slip stays above what the slip law asks for
/// - pressure_off_command: reading against uncorrected valve model differs by `off_command_Pa` for `off_command_s`, also on and off, or by the
///   residual pressure of the self-test where the model has none, armed or with load on the wheel; or the learnt offset of the valve is more
///   than the law may make up for, for `stuck_s`, also on and off
/// - maneuver_range: a commanded value outside its range, at once
/// - heartbeat_lost, emergency_stop, bus_off: at once after the age or event
/// - overrun: more than `overruns` missed periods in quick succession, at once or in pieces: ten good periods pay for a missed one
#pragma once

#include "firmware/control/config.hpp"
#include "firmware/control/estimator.hpp"
#include "firmware/control/persistence.hpp"
#include "firmware/control/types.hpp"

namespace antiskid::control {

class Monitor {
  public:
    /// What the controller did in the period before.
    struct Before {
        bool rolling;  ///< on the wheels and spun up since touchdown
        bool braking;  ///< a law acted
        float slip_reference;
    };

    explicit Monitor(const Config& config);

    /// Faults present in this period. `estimator` has already seen the same inputs.
    [[nodiscard]] FaultSet check(const Sensors& sensors, const Estimator& estimator, const Before& before,
                                 Time now);

  private:
    /// Age and refusals of one input.
    struct Arrival {
        Arrival(float max_age_s, float frame_period_s);
        Time max_age;
        float most_refused;
        Time received = kNever;
        std::uint32_t rejected = 0;
        std::uint32_t rejected_before = 0;
        float refused = 0.0F;  // frames, less those that were accepted
        enum class Verdict : std::uint8_t { good, lost, corrupt };
        Verdict judge(Time newest, std::uint32_t rejected_now, Time now);
    };
    /// Range and rate of one speed.
    struct SpeedCheck {
        SpeedCheck(float limit_s, float period_s)
            : range(limit_s, period_s), rate(limit_s, period_s), late(limit_s, period_s) {}
        Suspicion range;
        Suspicion rate;  // of fresh readings, each counted as one period
        Suspicion late;
        bool ranges = false, jumps = false, lags = false;  // what the newest fresh reading says
        float last_radps = 0.0F;
        bool known = false;
    };

    void check_arrivals(FaultSet& faults, const Sensors& sensors, Time now);
    void check_speed(FaultSet& faults, SpeedCheck& check, const SpeedReading& reading,
                     const EncoderConfig& encoder, Fault lost, Fault range, Fault rate) const;
    void check_pressure(FaultSet& faults, const Sensors& sensors, const Estimator& estimator);
    void check_plausibility(FaultSet& faults, const Sensors& sensors, const Estimator& estimator,
                            bool rolling);
    void check_law(FaultSet& faults, const ManeuverInput& maneuver, const Estimator& estimator,
                   const Before& before);
    void check_maneuver(FaultSet& faults, const ManeuverInput& maneuver) const;

    MonitorConfig config_;
    EncoderConfig wheel_encoder_;
    EncoderConfig flywheel_encoder_;
    float flywheel_radius_m_;
    float released_Pa_;
    float period_s_;
    float made_up_for_share_;
    Arrival wheel_, flywheel_, pressure_, maneuver_;
    Time heartbeat_max_age_;
    SpeedCheck wheel_speed_, flywheel_speed_;
    Suspicion pressure_range_, pressure_rate_, pressure_off_, valve_off_, free_slip_;
    float excess_slip_s_ = 0.0F;
    Persistence pressure_stuck_, pressure_stays_, wheel_stuck_, flywheel_stuck_, flywheel_blind_,
        flywheel_leaps_, overspeed_;
    bool pressure_jumps_ = false;
    bool blind_ = false, leaps_ = false;  // what the newest reading of the flywheel says
    float carried_mps_ = 0.0F;            // the speed that an aircraft must still have at least
    float reached_mps_ = 0.0F;            // the speed that an aircraft on its wheels has at most
    float last_reading_Pa_ = 0.0F;
    Time last_reading_at_ = kNever;
    float model_at_change_Pa_ = 0.0F;
    std::uint32_t overrun_score_ = 0;
};

}  // namespace antiskid::control
