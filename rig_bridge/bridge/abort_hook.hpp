/// A program of the operator's that is run when a maneuver was aborted: mail, a lamp, a message.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace rig::bridge {

/// What it is told, each in an environment variable of one line.
struct AbortNews {
    std::string outcome;           ///< RIG_OUTCOME: what the campaign does about it, for people
    std::string cause;             ///< RIG_CAUSE: name of the abort, or record_lost
    std::string next_step;         ///< RIG_NEXT_STEP: what it means and what to do
    std::string campaign;          ///< RIG_CAMPAIGN; empty: a single maneuver
    std::int64_t maneuver = 0;     ///< RIG_MANEUVER
    std::filesystem::path folder;  ///< RIG_FOLDER: of the record, absolute
};

[[nodiscard]] std::vector<std::string> environment_of(const AbortNews& news);

/// Throws std::invalid_argument where `program` is no file that may be run.
void check_hook(const std::filesystem::path& program);

inline constexpr std::chrono::seconds kHookLimit{10};

/// Runs it without a shell and without arguments, at ordinary priority, and waits for its end; after `limit` it is killed with all that it
/// started in its process group. Returns what went wrong; empty: it ended with 0.
[[nodiscard]] std::string run_hook(const std::filesystem::path& program, const std::vector<std::string>& news,
                                   std::chrono::milliseconds limit = kHookLimit);

}  // namespace rig::bridge
