/// The PLC's program: takes commands, monitors interlocks and the bridge, trips. Pure: each scan is a call that gets the time.
///
/// Commands. A commit (a new value of the commit register, not 0) is applied or rejected as a whole; after a rejection the previous commands stay in
/// force. The reason is the first of these that applies:
///     value               an enable or reset that is neither 0 nor 1, a number that is not finite
///     range               speed outside 0 to the drive's maximum; force or lift outside the loading device's range
///     load_law            load enabled, but eq. (2) falls below zero at the commanded speed or at the rim's present one
///     load_off_rim        load enabled without the sledge being sent to the rim
///     drive_against_load  drive and load enabled at once: the drive must not work against the loaded wheel
///     tripped             anything enabled while tripped, also together with a reset: after it a further commit is needed
///     interlock           reset while an interlock is open
///     unsupervised        anything enabled while the bridge's watchdog does not count
/// All else is allowed; in particular the wheel may be brought to a turning or resting flywheel, with the drive on or off.
///
/// Trip: an interlock opens, or the bridge's watchdog, once it has counted, has not counted for the watchdog time. Drive and load are then off and
/// the sledge moves back until a reset: a commit with `reset` 1 after one with 0, with all interlocks good and the bridge alive.
/// are off and the sledge goes back, until a commit resets: `reset` 1 after a commit with 0, all interlocks good, bridge alive.
#pragma once

#include <cstdint>
#include <string_view>

#include "rig_bridge/rig/quantities.hpp"

namespace plc {

enum class Rejection : std::uint8_t { none, value, range, load_law, load_off_rim, drive_against_load, tripped, interlock, unsupervised };
enum class Trip : std::uint8_t { none, emergency_stop, guard_open, hydraulics_lost, drive_fault, bridge_silent };
[[nodiscard]] std::string_view name(Rejection rejection);
[[nodiscard]] std::string_view name(Trip trip);

struct PlcLimits {
    double speed_max_mps = 0.0;
    double force_max_N = 0.0;
    double lift_max_Ns2pm2 = 0.0;
    double watchdog_s = 0.5;
};

/// Commands in force for the machines.
struct MachineCommands {
    bool drive = false;
    double speed_mps = 0.0;
    bool advance = false;
    bool load = false;
    double load_base_N = 0.0;
    double load_lift_Ns2pm2 = 0.0;
};

class VirtualPlc {
  public:
    explicit VirtualPlc(const PlcLimits& limits) : limits_(limits) {}

    /// One scan at `now_s`, which must not decrease. `good`: state of the interlocks, bit i is rig::Interlock i.
    void scan(const rig::CommandedValues& commanded, unsigned good, double rim_mps, double now_s);

    /// Accounts for `scans` scans until `now_s` in which nothing changed and the bridge was alive.
    void pass_idle(double now_s, std::uint64_t scans) {
        bridge_moved_s_ = now_s;
        watchdog_ = static_cast<std::uint16_t>(watchdog_ + scans);
    }

    [[nodiscard]] const MachineCommands& commands() const { return commands_; }
    [[nodiscard]] rig::PlcState state() const { return state_; }
    [[nodiscard]] Trip trip() const { return trip_; }                 ///< cause of the last trip, kept after the reset
    [[nodiscard]] Rejection rejection() const { return rejection_; }  ///< of rejected_commit()
    [[nodiscard]] std::uint16_t applied_commit() const { return applied_; }
    [[nodiscard]] std::uint16_t rejected_commit() const { return rejected_; }
    [[nodiscard]] std::uint16_t watchdog() const { return watchdog_; }

  private:
    void supervise(double watchdog, unsigned good, double now_s);
    void take(const rig::CommandedValues& commanded, unsigned good, double rim_mps);
    [[nodiscard]] Rejection judge(const rig::CommandedValues& commanded, unsigned good, double rim_mps) const;

    PlcLimits limits_;
    MachineCommands commands_;
    rig::PlcState state_ = rig::PlcState::ready;
    Trip trip_ = Trip::none;
    Rejection rejection_ = Rejection::none;
    double bridge_watchdog_ = 0.0;
    double bridge_moved_s_ = 0.0;
    bool bridge_seen_ = false;  // its watchdog has counted
    bool bridge_alive_ = false;
    bool reset_ = false;  // of the last applied commit
    std::uint16_t commit_ = 0;
    std::uint16_t applied_ = 0;
    std::uint16_t rejected_ = 0;
    std::uint16_t watchdog_ = 0;
};

}  // namespace plc
