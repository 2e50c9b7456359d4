/// Compares recorded with replayed frames of one sender, message by message, in order.
///
/// With alive counters in the layout, pairs are matched by counter, so that a missing frame does not shift all later pairs.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>

#include "firmware/can/layout.hpp"
#include "rig_bridge/replay/log_reader.hpp"

namespace rig::replay {

struct FrameDifference {
    antiskid::can::Role role{};
    std::uint64_t line = 0;  ///< of the recorded frame
    Time time{};             ///< in the log
    Frame recorded;
    Frame replayed;
};

/// Replayed minus recorded valve current.
[[nodiscard]] double current_difference_mA(const FrameDifference& valve_commands, const antiskid::can::Layout& layout);

class FrameComparison {
  public:
    struct Count {
        std::uint64_t compared = 0;
        std::uint64_t different = 0;
        std::uint64_t settling = 0;  ///< not compared: see expect_self_test()
        std::uint64_t only_recorded = 0;
        std::uint64_t only_replayed = 0;
    };

    /// `layout` must outlive the comparison.
    explicit FrameComparison(const antiskid::can::Layout& layout);

    /// For a log that begins while the controller was running: the replayed one starts with its self-test, and until both report that it has passed,
    /// only differences of commands are counted.
    void expect_self_test() { settling_ = true; }

    void recorded(antiskid::can::Role role, const LogFrame& frame);
    /// Frames of unknown identifiers are ignored.
    void replayed(const Frame& frame);
    /// Call at the end of the log: remaining frames have no partner. Closing frames of the replay that the log lacks are ignored.
    void finish();

    [[nodiscard]] const Count& count(antiskid::can::Role role) const { return sides_[static_cast<std::size_t>(role)].count; }
    [[nodiscard]] std::size_t waiting(antiskid::can::Role role) const { return sides_[static_cast<std::size_t>(role)].recorded.size(); }
    [[nodiscard]] const std::optional<FrameDifference>& first() const { return first_; }
    /// The first pair of valve commands with the largest difference of current.
    [[nodiscard]] const std::optional<FrameDifference>& largest() const { return largest_; }

  private:
    /// Number of frames by which one side may be ahead; beyond it the oldest has no partner.
    static constexpr std::size_t kAhead = 256;

    struct Sides {
        std::deque<LogFrame> recorded;
        std::deque<Frame> replayed;
        Count count;
    };
    [[nodiscard]] bool past_self_test(const Frame& status) const;
    void note(antiskid::can::Role role, const LogFrame& recorded, const Frame& replayed);
    void match(antiskid::can::Role role);
    /// By how many frames the replayed one is behind the recorded one; negative: ahead.
    [[nodiscard]] int behind(antiskid::can::Role role, const Frame& recorded, const Frame& replayed) const;

    const antiskid::can::Layout& layout_;
    std::array<Sides, antiskid::can::kRoleCount> sides_;
    std::optional<FrameDifference> first_;
    std::optional<FrameDifference> largest_;
    bool settling_ = false;
};

}  // namespace rig::replay
