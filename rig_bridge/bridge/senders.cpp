#include "rig_bridge/bridge/senders.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "firmware/can/e2e.hpp"

namespace rig::bridge {

using antiskid::can::E2e;
using antiskid::can::Frame;
using antiskid::can::Message;
using antiskid::can::Protection;
using antiskid::can::Role;

namespace {

/// A chain that was left is forgotten well before a lone sender's counter comes by again.
std::uint64_t frames_kept(const E2e& protection) {
    constexpr std::uint32_t kMax = 8;
    constexpr std::uint32_t kMargin = 3;
    return std::min(kMax, std::max<std::uint32_t>(protection.counter_modulo, kMargin) - kMargin);
}

bool whole(const Message& message, const Frame& frame) {
    const E2e& e2e = message.protection;
    if (frame.id != message.id || frame.length != message.length) return false;
    return e2e.protection != Protection::counter_crc || frame.data[e2e.crc_byte] == antiskid::can::e2e_crc(frame, e2e);
}

}  // namespace

Senders::Senders(const Message& message) : message_(message), kept_(frames_kept(message.protection)) {}

void Senders::accept(const Frame& frame) {
    if (!message_.bound || message_.protection.protection == Protection::none || !whole(message_, frame)) return;
    const antiskid::can::Payload payload(frame.data);
    follow(frame, static_cast<std::uint32_t>(payload.read(message_.protection.counter)));
}

bool Senders::lives(const Chain& chain) const {
    return chain.newest != 0 && frames_ - chain.newest <= kept_;
}

void Senders::follow(const Frame& frame, std::uint32_t counter) {
    constexpr std::uint32_t kKnown = 2;  // frames until a chain is a sender's
    ++frames_;
    std::size_t next = chains_.size();
    std::size_t oldest = 0;
    for (std::size_t i = 0; i < chains_.size(); ++i) {
        const Chain& chain = chains_[i];
        if (chain.newest < chains_[oldest].newest) oldest = i;
        const bool goes_on = lives(chain) && (chain.counter + 1) % message_.protection.counter_modulo == counter;
        // Of two that would go on, it is the turn of the one that has waited longer.
        if (goes_on && (next == chains_.size() || chain.newest < chains_[next].newest)) next = i;
    }
    if (next == chains_.size()) {
        chains_[oldest] = {.counter = counter, .run = 0, .newest = frames_, .data = frame.data};
        last_ = oldest;
        turns_ = 0;
        repeated_ = false;
        return;
    }
    Chain& chain = chains_[next];
    chain = {.counter = counter, .run = chain.run + 1, .newest = frames_, .data = frame.data};
    const Chain& other = chains_[last_];
    if (next != last_ && chain.run >= kKnown && other.run >= kKnown) {
        ++turns_;
        if (chain.counter == other.counter) repeated_ = chain.data == other.data;
        before_ = last_;
    }
    last_ = next;
}

bool Senders::several() const {
    constexpr std::uint32_t kSure = 8;  // turns; five happen to one sender, too
    return turns_ >= kSure && lives(chains_[before_]) && lives(chains_[last_]);
}

std::string Senders::text() const {
    if (!several()) return {};
    const std::uint32_t at = chains_[last_].counter;
    if (repeated_) return fmt::format("every frame of 0x{:03X} comes twice, at counter {}", message_.id, at);
    return fmt::format("two senders of 0x{:03X}, at counters {} and {}", message_.id, chains_[before_].counter, at);
}

DuplicateSenders::DuplicateSenders(const antiskid::can::Layout& layout)
    : valve_(layout[Role::valve]), status_(layout[Role::status]), maneuver_(layout[Role::maneuver]) {}

void DuplicateSenders::accept(const Frame& frame) {
    valve_.accept(frame);
    status_.accept(frame);
    maneuver_.accept(frame);
}

std::string DuplicateSenders::two_controllers() const {
    const std::string status = status_.text();
    return status.empty() ? valve_.text() : status;
}

}  // namespace rig::bridge
