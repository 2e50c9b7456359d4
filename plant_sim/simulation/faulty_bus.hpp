/// A CAN bus on a simulated clock, whose frames are lost, late, doubled or damaged on their way to one of its ends.
///
/// One thread. What strikes is drawn from the generator that is handed in, in the order of the frames: same calls, same frames.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <string_view>

#include "firmware/can/bus.hpp"
#include "rig_bridge/wear/draw.hpp"

namespace plant_sim::simulation {

/// `late`: by up to kMaxLate, so that others overtake it. `damaged`: one to three bits of its data, which a CRC of 8 bits
/// shows, but for a fiftieth of the frames of four bytes.
enum class FrameFault : std::uint8_t { lost, late, doubled, damaged };
inline constexpr std::size_t kFrameFaults = 4;

class FaultyBus {
  public:
    static constexpr antiskid::can::Time kMaxLate{60'000'000};

    class End final : public antiskid::can::Bus {
      public:
        End(FaultyBus& bus, bool deaf) : bus_(bus), deaf_(deaf) {}
        std::size_t receive(std::span<antiskid::can::Frame> frames) override;
        bool send(const antiskid::can::Frame& frame) override;
        /// Whether a frame is there; time does not pass here.
        bool wait(antiskid::can::Time timeout) override;
        [[nodiscard]] antiskid::can::LinkStatus status() const override { return status_; }

        /// Neither sends nor receives while it is down; what was on its way to it is gone.
        void set_up(bool up);
        /// Of the frames to this end, as they are sent, `share` suffer `fault`.
        void strike(FrameFault fault, double share) { shares_.at(static_cast<std::size_t>(fault)) = share; }
        void calm() { shares_.fill(0.0); }
        /// Frames of `sender` come whole: both are sockets of one computer, whose kernel echoes what it has sent.
        void on_computer_of(const End& sender) { neighbour_ = &sender; }

      private:
        friend class FaultyBus;
        struct Travelling {
            antiskid::can::Frame frame;  // received: when it arrives
            bool damaged = false;
        };
        void take(const antiskid::can::Frame& frame, const End& from);
        void insert(const Travelling& one);

        FaultyBus& bus_;
        bool deaf_;
        const End* neighbour_ = nullptr;
        std::deque<Travelling> queue_;  // earliest first
        std::array<double, kFrameFaults> shares_{};
        antiskid::can::LinkStatus status_;
    };

    /// Told of each frame as an end receives it, and whether it was damaged on the way.
    using Witness = std::function<void(const End& end, const antiskid::can::Frame& frame, bool damaged)>;

    FaultyBus(wear::Generator& draw, Witness witness) : draw_(draw), witness_(std::move(witness)) {}
    FaultyBus(const FaultyBus&) = delete;
    FaultyBus& operator=(const FaultyBus&) = delete;

    /// The bus owns it. `deaf`: it only sends.
    [[nodiscard]] End& connect(bool deaf = false) { return ends_.emplace_back(*this, deaf); }
    void set_time(antiskid::can::Time now) { now_ = now; }
    [[nodiscard]] const std::array<std::uint64_t, kFrameFaults>& struck() const { return struck_; }

  private:
    wear::Generator& draw_;
    Witness witness_;
    std::deque<End> ends_;
    antiskid::can::Time now_{};
    std::array<std::uint64_t, kFrameFaults> struck_{};
};

}  // namespace plant_sim::simulation
