/// Frames of one message that come and are refused: why, and whether the counters of two senders alternate in them. Silence and a second
/// sender look the same to whoever takes only good frames. Pure.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "firmware/can/layout.hpp"
#include "firmware/can/message_stats.hpp"

namespace rig {

class RefusedFrames {
  public:
    /// `layout` must outlive it.
    RefusedFrames(const antiskid::can::Layout& layout, antiskid::can::Role role);

    /// Every frame on the bus in its order, `received` by one clock; `stats` of the message after it.
    void accept(const antiskid::can::Frame& frame, const antiskid::can::MessageStats& stats);

    /// Two counters that each go on by one, frame after frame, turn by turn. Single frames that are doubled, late or lost are none.
    [[nodiscard]] bool two_senders() const;
    /// "counter; two senders of 0x180, at counters 3 and 9"; empty: none was refused since `since`.
    [[nodiscard]] std::string text(antiskid::can::Time since) const;

  private:
    struct Sender {
        std::uint32_t counter = 0;
        std::uint32_t run = 0;     ///< frames that went on by one
        std::uint64_t newest = 0;  ///< number of its newest frame
    };
    void follow(std::uint32_t counter);

    const antiskid::can::Message& message_;
    std::uint64_t frames_ = 0;
    std::array<Sender, 2> senders_{};
    antiskid::can::MessageStats before_;
    std::string reason_;
    antiskid::can::Time refused_ = antiskid::can::Time::min();
};

}  // namespace rig
