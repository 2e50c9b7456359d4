/// Recorded against replayed frames of one sender, message by message: the first recorded one with the first replayed one.
///
/// A frame that one side lacks does not shift all that follow: where the layout has alive counters, pairs are found by them.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

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

/// By how much the replayed valve command is above the recorded one.
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

    /// The recorded controller was running when the log began, the replayed one tests itself first: what else than commands
    /// differs until both say that they have passed it is not counted as different.
    void expect_self_test() { settling_ = true; }

    void recorded(antiskid::can::Role role, const LogFrame& frame);
    /// Frames of unknown identifiers are ignored.
    void replayed(const Frame& frame);
    /// At the end of the log: what is left has no partner. Closing frames of the replay that the log no longer has count for
    /// nothing.
    void finish();

    [[nodiscard]] const Count& count(antiskid::can::Role role) const { return sides_[static_cast<std::size_t>(role)].count; }
    [[nodiscard]] std::size_t waiting(antiskid::can::Role role) const { return sides_[static_cast<std::size_t>(role)].recorded.size(); }
    [[nodiscard]] const std::optional<FrameDifference>& first() const { return first_; }
    /// The valve commands whose currents are furthest apart, the first of them.
    [[nodiscard]] const std::optional<FrameDifference>& largest() const { return largest_; }

  private:
    /// One side may be ahead by this many frames; then the oldest has no partner.
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
