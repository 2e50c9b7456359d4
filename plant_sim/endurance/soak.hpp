/// Landings back to back in one TestCell, for as long as somebody wants to know whether anything creeps: memory, stop length, faults.
///
///     const endurance::SoakResult r = endurance::soak(setup, {.seconds = 86'400.0, .seed = 1}, heap_in_use);
///     if (!endurance::complaints(r).empty()) ...
///
/// The brake is a new one for each landing: what a brake does in its life is no creep. Time is the controller's own: while the brake cools it sleeps,
/// and that does not count. No wall clock, no memory of its own that grows.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "plant_sim/endurance/endurance_setup.hpp"

namespace endurance {

struct SoakOptions {
    double seconds = 86'400.0;
    std::uint64_t seed = 1;
    const std::atomic<bool>* stop = nullptr;  ///< looked at between two landings
};

/// One of kSpans equal spans of the time.
struct SoakSpan {
    std::int64_t landings = 0;
    double length_m_mean = 0.0;       ///< brake-on to drop-out or standstill, as the meter has it
    double length_m_deviation = 0.0;  ///< of the landings from that mean
    std::size_t max_heap_bytes = 0;   ///< in use after a landing
};

struct SoakResult {
    static constexpr std::size_t kSpans = 12;
    double seconds = 0.0;  ///< of the controller
    std::int64_t landings = 0;
    std::string ended_by;  ///< what was wrong with the last landing; empty: nothing
    std::array<SoakSpan, kSpans> spans{};
};

/// `heap_bytes` tells what the process has allocated. `observe` gets the share of the time that is over. Ends at the first landing that is
/// aborted or has a fault.
[[nodiscard]] SoakResult soak(const EnduranceSetup& setup, const SoakOptions& options, const std::function<std::size_t()>& heap_bytes,
                              const std::function<void(double share)>& observe = {});

/// What must not be: a landing that went wrong; more heap in use in any span than in the second (the first is for warming up); a mean length
/// in the last third that is off that of the first by more than four of its standard errors. Empty: nothing.
[[nodiscard]] std::vector<std::string> complaints(const SoakResult& result);

/// For a machine: result and complaints.
[[nodiscard]] std::string to_json(const SoakResult& result, const EnduranceSetup& setup, std::uint64_t seed);

}  // namespace endurance
