/// Landings one after the other in a TestCell, to find slow growth of memory use and slow changes of the stop length, and faults.
///
///     const endurance::SoakResult r = endurance::soak(setup, {.seconds = 86'400.0, .seed = 1}, heap_in_use);
///     if (!endurance::violations(r).empty()) ...
///
/// Each landing has a new brake, since wear would change the stop length. Time is the controller's: it does not run while the brake cools. The wall
/// clock is not used, and the memory of the soak itself does not grow.
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
    const std::atomic<bool>* stop = nullptr;  ///< checked between two landings
};

/// Results of one of kSpans equal parts of the time.
struct SoakSpan {
    std::int64_t landings = 0;
    double length_m_mean = 0.0;       ///< from brake-on to drop-out or standstill, by the meter
    double length_m_deviation = 0.0;  ///< standard deviation of the landings
    std::size_t max_heap_bytes = 0;   ///< largest heap in use after a landing
};

struct SoakResult {
    static constexpr std::size_t kSpans = 12;
    double seconds = 0.0;  ///< time of the controller
    std::int64_t landings = 0;
    std::string ended_by;  ///< what was wrong with the last landing; empty: nothing
    std::array<SoakSpan, kSpans> spans{};
};

/// `heap_bytes` returns the bytes that the process has allocated. `observe` is called with the share of the time that has passed. Ends at the first
/// landing that is aborted or has a fault.
[[nodiscard]] SoakResult soak(const EnduranceSetup& setup, const SoakOptions& options, const std::function<std::size_t()>& heap_bytes,
                              const std::function<void(double share)>& observe = {});

/// Failed requirements, empty if none: the last landing was aborted or had a fault; some span has more heap in use than the second (in the first,
/// buffers reach their size); the mean stop length of the last third differs from that of the first by more than four standard errors.
[[nodiscard]] std::vector<std::string> violations(const SoakResult& result);

/// Result and violations as JSON.
[[nodiscard]] std::string to_json(const SoakResult& result, const EnduranceSetup& setup, std::uint64_t seed);

}  // namespace endurance
