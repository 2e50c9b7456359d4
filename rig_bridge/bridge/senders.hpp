/// Detects whether several programs send the same identifier: alternating alive counters that each advance by one. Pure.
///
/// Occasional lost, late, doubled or damaged frames, or a restart, do not make one sender look like two: its counter does not advance alternately in
/// two places. Fourteen consecutive frames of two senders suffice, whatever their counters; a counter of 2 bits is too short.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "firmware/can/layout.hpp"

namespace rig::bridge {

class Senders {
  public:
    /// `message` must outlive it.
    explicit Senders(const antiskid::can::Message& message);

    /// Takes every frame in bus order; other messages, damaged frames and repeats of single frames are ignored.
    void accept(const antiskid::can::Frame& frame);

    [[nodiscard]] bool several() const;
    /// "two senders of 0x180, at counters 3 and 9"; "every frame of 0x180 comes twice, at counter 3", if both send the same counter (or one program
    /// repeats the other's frames); empty: one sender or none.
    [[nodiscard]] std::string text() const;

  private:
    struct Chain {
        std::uint32_t counter = 0;
        std::uint32_t run = 0;     ///< frames whose counter advanced by one
        std::uint64_t newest = 0;  ///< number of its newest frame; 0: none
        std::array<std::uint8_t, 8> data{};
    };
    [[nodiscard]] bool lives(const Chain& chain) const;
    void follow(const antiskid::can::Frame& frame, std::uint32_t counter);

    const antiskid::can::Message& message_;
    std::uint64_t kept_;  // largest number of other senders' frames between two of one sender
    std::uint64_t frames_ = 0;
    std::array<Chain, 3> chains_{};
    std::size_t last_ = 0;    // the chain of the newest frame
    std::size_t before_ = 0;  // the chain before that
    std::uint32_t turns_ = 0;
    bool repeated_ = false;  // the newest two of one counter had the same bytes
};

/// Detects second senders of messages that only one program of a rig may send.
class DuplicateSenders {
  public:
    /// `layout` must outlive it.
    explicit DuplicateSenders(const antiskid::can::Layout& layout);

    /// Every frame on the bus, in its order.
    void accept(const antiskid::can::Frame& frame);

    /// What shows that there are two, as Senders::text() says it; empty: nothing does. Commands to the valve come most often, and from any
    /// controller that steps; status frames from one that waits for its SYNC, too.
    [[nodiscard]] std::string two_controllers() const;
    [[nodiscard]] std::string two_bridges() const { return maneuver_.text(); }

  private:
    Senders valve_;
    Senders status_;
    Senders maneuver_;
};

}  // namespace rig::bridge
