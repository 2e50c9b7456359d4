#include "plant_sim/plc/virtual_plc.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace plc {

using rig::Commanded;
using rig::CommandedValues;

namespace {

constexpr unsigned kAllGood = (1U << rig::kInterlockCount) - 1U;

/// In the order of rig::Interlock.
constexpr std::array<Trip, rig::kInterlockCount> kTrips{Trip::emergency_stop, Trip::guard_open, Trip::hydraulics_lost, Trip::drive_fault};

bool set(const CommandedValues& c, Commanded q) {
    return rig::at(c, q) == 1.0;
}

bool switches_are_0_or_1(const CommandedValues& c) {
    constexpr std::array kSwitches{Commanded::drive_enable, Commanded::sledge_advance, Commanded::load_enable, Commanded::reset};
    return std::all_of(kSwitches.begin(), kSwitches.end(), [&c](Commanded q) { return rig::at(c, q) == 0.0 || rig::at(c, q) == 1.0; });
}

/// False for NaN, too.
bool within(double value, double max) {
    return value >= 0.0 && value <= max;
}

}  // namespace

std::string_view name(Rejection rejection) {
    constexpr std::array<std::string_view, 9> kNames{"none",
                                                     "a switch is neither 0 nor 1",
                                                     "out of range",
                                                     "the law of the load falls below zero",
                                                     "load without the sledge at the rim",
                                                     "drive against the loaded wheel",
                                                     "tripped",
                                                     "reset with an open interlock",
                                                     "the bridge's watchdog does not move"};
    return kNames[static_cast<std::size_t>(rejection)];
}

std::string_view name(Trip trip) {
    constexpr std::array<std::string_view, 6> kNames{
        "none", "emergency stop", "guard open", "hydraulic pressure lost", "drive fault", "the bridge's watchdog stood still"};
    return kNames[static_cast<std::size_t>(trip)];
}

void VirtualPlc::scan(const CommandedValues& commanded, unsigned good, double rim_mps, double now_s) {
    ++watchdog_;
    supervise(rig::at(commanded, Commanded::bridge_watchdog), good, now_s);
    const double commit = rig::at(commanded, Commanded::commit);
    if (within(commit, 65535.0) && commit != 0.0 && commit != static_cast<double>(commit_)) {
        commit_ = static_cast<std::uint16_t>(commit);
        take(commanded, good, rim_mps);
    }
}

void VirtualPlc::supervise(double watchdog, unsigned good, double now_s) {
    if (watchdog != bridge_watchdog_ && std::isfinite(watchdog)) {
        bridge_watchdog_ = watchdog;
        bridge_moved_s_ = now_s;
        bridge_seen_ = true;
        bridge_alive_ = true;
    } else if (now_s - bridge_moved_s_ >= limits_.watchdog_s) {
        bridge_alive_ = false;
    }
    if (state_ == rig::PlcState::tripped) return;
    Trip cause = bridge_seen_ && !bridge_alive_ ? Trip::bridge_silent : Trip::none;
    for (std::size_t i = kTrips.size(); i-- > 0;) {
        if ((good >> i & 1U) == 0U) cause = kTrips[i];
    }
    if (cause == Trip::none) return;
    trip_ = cause;
    state_ = rig::PlcState::tripped;
    commands_ = {};
}

Rejection VirtualPlc::judge(const CommandedValues& c, unsigned good, double rim_mps) const {
    if (!switches_are_0_or_1(c)) return Rejection::value;
    const double speed = rig::at(c, Commanded::flywheel_speed_mps);
    const double base = rig::at(c, Commanded::load_base_N);
    const double lift = rig::at(c, Commanded::load_lift_Ns2pm2);
    if (!std::isfinite(speed) || !std::isfinite(base) || !std::isfinite(lift)) return Rejection::value;
    if (!within(speed, limits_.speed_max_mps) || !within(base, limits_.force_max_N) || !within(lift, limits_.lift_max_Ns2pm2))
        return Rejection::range;
    const bool drive = set(c, Commanded::drive_enable);
    const bool advance = set(c, Commanded::sledge_advance);
    const bool load = set(c, Commanded::load_enable);
    const double fastest = std::max(rim_mps, drive ? speed : 0.0);
    if (load && base - lift * fastest * fastest < 0.0) return Rejection::load_law;
    if (load && !advance) return Rejection::load_off_rim;
    if (load && drive) return Rejection::drive_against_load;
    const bool any = drive || advance || load;
    if (any && state_ == rig::PlcState::tripped) return Rejection::tripped;
    if (set(c, Commanded::reset) && good != kAllGood) return Rejection::interlock;
    if ((any || set(c, Commanded::reset)) && !bridge_alive_) return Rejection::unsupervised;
    return Rejection::none;
}

void VirtualPlc::take(const CommandedValues& c, unsigned good, double rim_mps) {
    const Rejection rejection = judge(c, good, rim_mps);
    if (rejection != Rejection::none) {
        rejection_ = rejection;
        rejected_ = commit_;
        return;
    }
    applied_ = commit_;
    if (set(c, Commanded::reset) && !reset_) state_ = rig::PlcState::ready;
    reset_ = set(c, Commanded::reset);
    commands_ = {.drive = set(c, Commanded::drive_enable),
                 .speed_mps = rig::at(c, Commanded::flywheel_speed_mps),
                 .advance = set(c, Commanded::sledge_advance),
                 .load = set(c, Commanded::load_enable),
                 .load_base_N = rig::at(c, Commanded::load_base_N),
                 .load_lift_Ns2pm2 = rig::at(c, Commanded::load_lift_Ns2pm2)};
}

}  // namespace plc
