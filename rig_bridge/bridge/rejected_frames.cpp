#include "rig_bridge/bridge/rejected_frames.hpp"

namespace rig::bridge {

using antiskid::can::Frame;
using antiskid::can::MessageStats;
using antiskid::can::Time;

RejectedFrames::RejectedFrames(const antiskid::can::Layout& layout, antiskid::can::Role role) : message_(layout[role]) {}

void RejectedFrames::accept(const Frame& frame, const MessageStats& stats) {
    if (!message_.bound || frame.id != message_.id) return;
    if (stats.rejected() != before_.rejected()) {
        rejected_ = frame.received;
        reason_ = stats.wrong_counter != before_.wrong_counter ? "counter"
                  : stats.wrong_crc != before_.wrong_crc       ? "CRC"
                  : stats.wrong_length != before_.wrong_length ? "length"
                                                               : "value";
    }
    before_ = stats;
}

std::string RejectedFrames::reason(Time since) const {
    return rejected_ < since ? std::string{} : reason_;
}

}  // namespace rig::bridge
