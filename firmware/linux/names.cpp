#include "firmware/linux/names.hpp"

#include <array>
#include <cstddef>

namespace antiskid::rt {

namespace {

using control::Fault;
using control::kFaultCount;
using control::kStateCount;
using control::State;

constexpr std::array<std::string_view, kStateCount> kStates{
    "self_test", "standby", "armed", "touchdown_protection", "braking", "locked_wheel", "drop_out", "safe"};

constexpr std::array<std::string_view, kFaultCount> kFaults{
    "wheel_lost",     "wheel_corrupt",      "wheel_range",      "wheel_rate",      "wheel_stuck",
    "flywheel_lost",  "flywheel_corrupt",   "flywheel_range",   "flywheel_rate",   "flywheel_stuck",
    "pressure_lost",  "pressure_corrupt",   "pressure_range",   "pressure_rate",   "pressure_stuck",
    "speeds_disagree", "pressure_off_command", "maneuver_lost", "maneuver_corrupt", "maneuver_range",
    "heartbeat_lost", "emergency_stop",     "bus_off",          "overrun",         "lock_persists",
    "self_test_failed"};

static_assert(kStates.back() == "safe" && static_cast<std::size_t>(State::safe) + 1 == kStateCount);
static_assert(kFaults[static_cast<std::size_t>(Fault::pressure_lost)] == "pressure_lost");
static_assert(kFaults[static_cast<std::size_t>(Fault::heartbeat_lost)] == "heartbeat_lost");
static_assert(kFaults.back() == "self_test_failed" &&
              static_cast<std::size_t>(Fault::self_test_failed) + 1 == kFaultCount);

template <std::size_t N>
std::string_view entry(const std::array<std::string_view, N>& table, const std::size_t number) {
    return number < N ? table[number] : "unknown";
}

}  // namespace

std::string_view name(const State state) { return entry(kStates, static_cast<std::size_t>(state)); }

std::string_view name(const Fault fault) { return entry(kFaults, static_cast<std::size_t>(fault)); }

std::vector<std::string_view> names(const control::FaultSet faults) {
    std::vector<std::string_view> result;
    for (std::uint8_t number = 0; number < kFaultCount; ++number)
        if (const auto fault = static_cast<Fault>(number); faults.contains(fault)) result.push_back(name(fault));
    return result;
}

}  // namespace antiskid::rt
