/// Whether one program sends an identifier, or several do: by alive counters that each go on by one, turn by turn. Pure.
///
/// A sender whose frames are lost, late, doubled or damaged now and then, or that starts anew, is one: its counter never goes on in two places
/// by turns. Fourteen frames of two in a row tell them, wherever their counters stand; a counter of 2 bits tells nothing.
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

    /// Every frame on the bus, in its order; those of others, damaged ones and repeats of single frames say nothing.
    void accept(const antiskid::can::Frame& frame);

    [[nodiscard]] bool several() const;
    /// "two senders of 0x180, at counters 3 and 9"; "every frame of 0x180 comes twice, at counter 3", where both say the same, which may also be
    /// one sender and somebody who repeats it; empty: there is one, or none.
    [[nodiscard]] std::string text() const;

  private:
    struct Chain {
        std::uint32_t counter = 0;
        std::uint32_t run = 0;     ///< frames that went on by one
        std::uint64_t newest = 0;  ///< number of its newest frame; 0: none
        std::array<std::uint8_t, 8> data{};
    };
    [[nodiscard]] bool lives(const Chain& chain) const;
    void follow(const antiskid::can::Frame& frame, std::uint32_t counter);

    const antiskid::can::Message& message_;
    std::uint64_t kept_;  // frames of others that may come between two of a sender
    std::uint64_t frames_ = 0;
    std::array<Chain, 3> chains_{};
    std::size_t last_ = 0;    // the chain of the newest frame
    std::size_t before_ = 0;  // the one whose turn it was before
    std::uint32_t turns_ = 0;
    bool repeated_ = false;  // the newest two of one counter had the same bytes
};

/// What only one program of a rig may send, by its identifiers.
class WhoSends {
  public:
    /// `layout` must outlive it.
    explicit WhoSends(const antiskid::can::Layout& layout);

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
