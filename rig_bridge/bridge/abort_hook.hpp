/// Runs the operator's program after an aborted maneuver, e.g. to send a message or switch on a lamp.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace rig::bridge {

/// Data for the program, each in an environment variable of one line.
struct AbortReport {
    std::string outcome;           ///< RIG_OUTCOME: what the campaign does about it, for people
    std::string cause;             ///< RIG_CAUSE: name of the abort, or record_lost
    std::string next_step;         ///< RIG_NEXT_STEP: what it means and what to do
    std::string campaign;          ///< RIG_CAMPAIGN; empty: a single maneuver
    std::int64_t maneuver = 0;     ///< RIG_MANEUVER
    std::filesystem::path folder;  ///< RIG_FOLDER: of the record, absolute
};

[[nodiscard]] std::vector<std::string> environment_of(const AbortReport& report);

/// Throws std::invalid_argument if `program` is not an executable file.
void check_hook(const std::filesystem::path& program);

inline constexpr std::chrono::seconds kHookLimit{10};

/// Runs the program without shell or arguments, at ordinary priority, and waits for its end; after `limit` kills it with its process group. Returns
/// what went wrong; empty: exit status 0.
[[nodiscard]] std::string run_hook(const std::filesystem::path& program, const std::vector<std::string>& environment,
                                   std::chrono::milliseconds limit = kHookLimit);

}  // namespace rig::bridge
