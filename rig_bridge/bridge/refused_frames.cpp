#include "rig_bridge/bridge/refused_frames.hpp"

namespace rig {

using antiskid::can::Frame;
using antiskid::can::MessageStats;
using antiskid::can::Time;

RefusedFrames::RefusedFrames(const antiskid::can::Layout& layout, antiskid::can::Role role) : message_(layout[role]) {}

void RefusedFrames::accept(const Frame& frame, const MessageStats& stats) {
    if (!message_.bound || frame.id != message_.id) return;
    if (stats.rejected() != before_.rejected()) {
        refused_ = frame.received;
        reason_ = stats.wrong_counter != before_.wrong_counter ? "counter"
                  : stats.wrong_crc != before_.wrong_crc       ? "CRC"
                  : stats.wrong_length != before_.wrong_length ? "length"
                                                               : "value";
    }
    before_ = stats;
}

std::string RefusedFrames::reason(Time since) const {
    return refused_ < since ? std::string{} : reason_;
}

}  // namespace rig
