/// Why frames of one message are refused, to tell a sender of bad frames from a silent one. Pure.
#pragma once

#include <string>

#include "firmware/can/layout.hpp"
#include "firmware/can/message_stats.hpp"

namespace rig::bridge {

class RejectedFrames {
  public:
    /// `layout` must outlive it.
    RejectedFrames(const antiskid::can::Layout& layout, antiskid::can::Role role);

    /// Takes every frame in bus order, with `received` on one clock; `stats`: of the message, after this frame.
    void accept(const antiskid::can::Frame& frame, const antiskid::can::MessageStats& stats);

    /// "counter", "CRC", "length" or "value": reason for the newest refused frame; empty: none was refused since `since`.
    [[nodiscard]] std::string reason(antiskid::can::Time since) const;

  private:
    const antiskid::can::Message& message_;
    antiskid::can::MessageStats before_;
    std::string reason_;
    antiskid::can::Time rejected_ = antiskid::can::Time::min();
};

}  // namespace rig::bridge
