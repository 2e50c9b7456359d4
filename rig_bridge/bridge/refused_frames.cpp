#include "rig_bridge/bridge/refused_frames.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace rig {

using antiskid::can::Frame;
using antiskid::can::MessageStats;
using antiskid::can::Protection;
using antiskid::can::Time;

RefusedFrames::RefusedFrames(const antiskid::can::Layout& layout, antiskid::can::Role role)
    : message_(layout[role]) {}

void RefusedFrames::accept(const Frame& frame, const MessageStats& stats) {
    if (!message_.bound || frame.id != message_.id) return;
    const bool damaged = stats.wrong_crc != before_.wrong_crc || stats.wrong_length != before_.wrong_length;
    if (stats.rejected() != before_.rejected()) {
        refused_ = frame.received;
        reason_ = stats.wrong_counter != before_.wrong_counter ? "counter"
                  : stats.wrong_crc != before_.wrong_crc       ? "CRC"
                  : stats.wrong_length != before_.wrong_length ? "length"
                                                               : "value";
    }
    before_ = stats;
    if (damaged || message_.protection.protection == Protection::none) return;
    const antiskid::can::Payload payload(frame.data);
    follow(static_cast<std::uint32_t>(payload.read(message_.protection.counter)));
}

void RefusedFrames::follow(std::uint32_t counter) {
    ++frames_;
    const auto goes_on = [&](const Sender& sender) {
        return sender.newest != 0 && (sender.counter + 1) % message_.protection.counter_modulo == counter;
    };
    const auto next = std::find_if(senders_.begin(), senders_.end(), goes_on);
    if (next != senders_.end()) {
        *next = {.counter = counter, .run = next->run + 1, .newest = frames_};
        return;
    }
    auto& oldest = senders_[senders_[0].newest <= senders_[1].newest ? 0 : 1];
    oldest = {.counter = counter, .run = 0, .newest = frames_};
}

bool RefusedFrames::two_senders() const {
    constexpr std::uint32_t kSure = 8;
    constexpr std::uint64_t kTurn = 8;  // frames of the other that may come between
    return std::all_of(senders_.begin(), senders_.end(), [this](const Sender& sender) {
        return sender.run >= kSure && frames_ - sender.newest <= kTurn;
    });
}

std::string RefusedFrames::text(Time since) const {
    if (refused_ < since) return {};
    if (!two_senders()) return reason_;
    return fmt::format("{}; two senders of 0x{:03X}, at counters {} and {}", reason_, message_.id,
                       senders_[0].counter, senders_[1].counter);
}

}  // namespace rig
