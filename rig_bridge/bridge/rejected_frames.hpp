/// Frames of one message that come and are refused, and why: to whoever takes only good frames they are silence. Pure.
#pragma once

#include <string>

#include "firmware/can/layout.hpp"
#include "firmware/can/message_stats.hpp"

namespace rig::bridge {

class RejectedFrames {
  public:
    /// `layout` must outlive it.
    RejectedFrames(const antiskid::can::Layout& layout, antiskid::can::Role role);

    /// Every frame on the bus in its order, `received` by one clock; `stats` of the message after it.
    void accept(const antiskid::can::Frame& frame, const antiskid::can::MessageStats& stats);

    /// "counter", "CRC", "length", "value": of the newest; empty: none was refused since `since`.
    [[nodiscard]] std::string reason(antiskid::can::Time since) const;

  private:
    const antiskid::can::Message& message_;
    antiskid::can::MessageStats before_;
    std::string reason_;
    antiskid::can::Time rejected_ = antiskid::can::Time::min();
};

}  // namespace rig::bridge
