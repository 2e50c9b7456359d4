/// Replays a recorded log through the program's own loop, port and controller, with the log in place of bus and clock, and compares the frames sent
/// with the recorded ones.
///
/// Not replayed, because not in the log: bus-off and interface state of the controller's chip.
#pragma once

#include <filesystem>
#include <string>

#include "firmware/controller/controller_setup.hpp"
#include "rig_bridge/replay/frame_comparison.hpp"
#include "rig_bridge/replay/recorded_pacer.hpp"

namespace rig::replay {

struct ControllerReplayReport {
    std::string log;
    bool lockstep = false;
    std::uint64_t steps = 0;
    std::uint64_t unsynchronised = 0;
    std::uint64_t unanswered = 0;
    std::optional<std::uint64_t> steps_before_log;  ///< see RecordedPacer
    std::array<FrameComparison::Count, antiskid::can::kRoleCount> counts{};
    std::optional<FrameDifference> first;
    std::optional<FrameDifference> largest;  ///< of the valve commands
    double recorded_s = 0.0;                 ///< rig time from first to last command
    double took_s = 0.0;                     ///< wall clock, reading the log included
    std::uint64_t lines = 0;
    std::string warnings;  ///< of the log, by kind
    std::string config_hash;

    [[nodiscard]] const FrameComparison::Count& count(antiskid::can::Role role) const { return counts[static_cast<std::size_t>(role)]; }
    /// Every command frame of the log was replayed, and none of the controller's frames differs.
    [[nodiscard]] bool same() const;
};

/// Throws std::runtime_error when the log cannot be read or holds no valve command.
[[nodiscard]] ControllerReplayReport replay_controller(const std::filesystem::path& log, const LogOptions& options,
                                                       const antiskid::controller::ControllerSetup& setup, ReplayClock clock, LogWarnings& warnings);

[[nodiscard]] std::string to_text(const ControllerReplayReport& report, const antiskid::can::Layout& layout);
[[nodiscard]] std::string to_json(const ControllerReplayReport& report, const antiskid::can::Layout& layout);

}  // namespace rig::replay
