/// Judges a run by criteria that were fixed before the first run (docs/engineering/fault_campaign.md, "The fault campaign").
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "firmware/control/types.hpp"

namespace faults {

enum class Outcome : std::uint8_t {
    handled,   ///< the loss of distance is within its bound, or a changed command was obeyed
    degraded,  ///< a larger loss within its own bound, and a fault named
    safe,      ///< fault named, safe current at the valve within the bound
    unsafe,    ///< all other outcomes
};
inline constexpr std::array<std::string_view, 4> kOutcomeNames{"handled", "degraded", "safe", "UNSAFE"};
[[nodiscard]] constexpr std::string_view name(Outcome outcome) {
    return kOutcomeNames[static_cast<std::size_t>(outcome)];
}

/// Reason why a run is unsafe.
enum class Hazard : std::uint8_t {
    none,
    unasked_pressure,  ///< more pressure at the brake than the sequencer demands
    locked_wheel,      ///< a locked wheel under pressure
    late_safe,         ///< the controller is in its safe state, the valve's driver does not give the safe current in time
    stop_not_heard,    ///< an emergency stop without effect
    silent_loss,       ///< loss of braking without a named fault
};
inline constexpr std::array<std::string_view, 6> kHazardNames{"none",      "unasked_pressure", "locked_wheel",
                                                              "late_safe", "stop_not_heard",   "silent_loss"};
[[nodiscard]] constexpr std::string_view name(Hazard hazard) {
    return kHazardNames[static_cast<std::size_t>(hazard)];
}

/// Limits of the criteria.
struct Bounds {
    double handled_share = 1.15;  ///< largest distance from the fault's beginning to standstill, relative to the fault-free run's
    double degraded_share = 1.5;
    double distance_slack_m = 1.0;           ///< added to both
    double unasked_Pa = 1e6;                 ///< pressure above the demand ...
    double unasked_s = 0.25;                 ///< ... for this time
    double lock_slip = 0.95;                 ///< a locked wheel ...
    double lock_pressure_Pa = 0.5e6;         ///< ... under pressure ...
    double lock_above_mps = 6.0;             ///< ... at a speed above ...
    double lock_s = 0.25;                    ///< ... for this time
    std::uint32_t safe_within_periods = 21;  ///< from the controller's safe state to the safe current at the valve's driver
    double stop_within_s = 0.5;              ///< from the emergency stop to State::safe
};

/// The plant's true state and the controller's status, once a period.
struct Observation {
    double period_s = 0.0;
    double distance_m = 0.0;  ///< since brake-on
    double v_mps = 0.0;
    double slip = 0.0;
    double pressure_Pa = 0.0;
    double asked_Pa = 0.0;   ///< demand of the sequencer: 0 if it does not arm, or the wheel carries no load
    double driver_mA = 0.0;  ///< current commanded at the valve's driver
    antiskid::control::State state{};
    antiskid::control::FaultSet named;
    bool received = true;  ///< whether the valve's driver got a command within its own time limit
};

/// Expectations for the run.
struct Expectation {
    double sound_distance_m = 0.0;  ///< of the fault-free stop
    double safe_mA = 0.0;
    bool changed_wish = false;    ///< the fault changes the command: less braking may be right
    bool emergency_stop = false;  ///< pressed when the fault begins
};

struct Judgement {
    Outcome outcome{};
    Hazard hazard{};
    antiskid::control::FaultSet named;  ///< latched since the fault began
    double named_after_s = -1.0;        ///< from the fault's beginning to the first name; negative: none
    double distance_share = 1.0;        ///< from the fault's beginning to the end, relative to the fault-free run
    double longest_lock_s = 0.0;
    double max_uncommanded_Pa = 0.0;
    bool operator==(const Judgement&) const = default;
};

class Judge {
  public:
    Judge(const Bounds& bounds, const Expectation& expected) : bounds_(bounds), expected_(expected) {}

    /// Call in every period from the fault's beginning on.
    void observe(const Observation& seen);
    /// `stood`: whether the aircraft came to rest.
    [[nodiscard]] Judgement verdict(bool stood) const;

  private:
    void raise(Hazard hazard) {
        if (hazard_ == Hazard::none) hazard_ = hazard;
    }

    Bounds bounds_;
    Expectation expected_;
    Hazard hazard_ = Hazard::none;
    antiskid::control::FaultSet named_;
    bool begun_ = false;
    bool lock_protection_ = false;
    bool fell_silent_ = false;
    bool permitted_ = false;  // any state but self-test, standby and safe
    bool stop_heard_ = false;
    double begun_at_m_ = 0.0;
    double now_m_ = 0.0;
    double passed_s_ = 0.0;
    double named_after_s_ = -1.0;
    double unasked_s_ = 0.0;
    double max_uncommanded_Pa_ = 0.0;
    double lock_s_ = 0.0;
    double longest_lock_s_ = 0.0;
    std::uint32_t not_safe_yet_ = 0;  // periods
};

}  // namespace faults
