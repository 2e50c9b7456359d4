#include "firmware/can/frame_gate.hpp"

namespace antiskid::can {

FrameGate::FrameGate(const Layout& layout, std::span<const Role> roles) : layout_(layout) {
    role_of_.fill(kNobody);
    for (const Role role : roles) {
        if (layout[role].bound) role_of_[layout[role].id] = static_cast<std::uint8_t>(role);
    }
}

FrameGate::Result FrameGate::check(const Frame& frame, const Payload& payload) {
    if (frame.id >= role_of_.size() || role_of_[frame.id] == kNobody) {
        ++unknown_ids_;
        return {};
    }
    const std::size_t index = role_of_[frame.id];
    const Message& message = layout_.messages[index];
    MessageStats& stats = stats_[index];
    Result verdict{.role = static_cast<Role>(index), .ok = false};
    if (frame.length != message.length) {
        ++stats.wrong_length;
        return verdict;
    }
    switch (checkers_[index].check(message.protection, frame, payload, stats.lost)) {
        case E2eResult::ok:
            verdict.ok = true;
            break;
        case E2eResult::wrong_crc:
            ++stats.wrong_crc;
            break;
        default:  // repeated, wrong_sequence
            ++stats.wrong_counter;
            break;
    }
    return verdict;
}

}  // namespace antiskid::can
