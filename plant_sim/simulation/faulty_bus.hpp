/// A CAN bus on a simulated clock whose frames may be lost, late, doubled or damaged on their way to a receiver.
///
/// For one thread. Faults are drawn from the given generator in the order of the frames: the same calls give the same frames.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <utility>
#include <vector>

#include "firmware/can/bus.hpp"
#include "rig_bridge/wear/draw.hpp"

namespace plant_sim::simulation {

/// `late`: by up to kMaxLate, so that other frames overtake it. `damaged`: one to three bits of the data change, which a CRC of 8 bits detects in all
/// but a fiftieth of the frames of four bytes.
enum class FrameFault : std::uint8_t { lost, late, doubled, damaged };
inline constexpr std::size_t kFrameFaults = 4;

class FaultyBus {
  public:
    static constexpr antiskid::can::Time kMaxLate{60'000'000};

    class End final : public antiskid::can::Bus {
      public:
        /// Called with each frame that the end receives, and whether it was damaged.
        using Observer = std::function<void(const antiskid::can::Frame& frame, bool damaged)>;

        End(FaultyBus& bus, bool send_only) : bus_(bus), send_only_(send_only) {}
        std::size_t receive(std::span<antiskid::can::Frame> frames) override;
        bool send(const antiskid::can::Frame& frame) override;
        /// Whether a frame can be received. No time passes.
        bool wait(antiskid::can::Time timeout) override;
        [[nodiscard]] antiskid::can::LinkStatus status() const override { return status_; }

        /// While it is down it neither sends nor receives; frames under way to it are lost.
        void set_up(bool up);
        /// Sets the share of the frames sent to this end that get `fault`.
        void set_share(FrameFault fault, double share) { shares_.at(static_cast<std::size_t>(fault)) = share; }
        void clear_faults() { shares_.fill(0.0); }
        void observe(Observer observer) { observer_ = std::move(observer); }
        /// Frames of `sender` always arrive undamaged: both ends are sockets of one computer, whose kernel echoes the frames.
        void on_computer_of(const End& sender) { neighbour_ = &sender; }

      private:
        friend class FaultyBus;
        /// A frame under way.
        struct Travelling {
            antiskid::can::Frame frame;  // `received`: its arrival time
            bool damaged = false;
        };
        void take(const antiskid::can::Frame& frame, const End& from);
        void insert(const Travelling& one);

        FaultyBus& bus_;
        bool send_only_;
        const End* neighbour_ = nullptr;
        Observer observer_;
        std::vector<Travelling> queue_;  // earliest first; short, as it is emptied each period
        std::array<double, kFrameFaults> shares_{};
        antiskid::can::LinkStatus status_;
    };

    explicit FaultyBus(wear::Generator& draw) : draw_(draw) {}
    FaultyBus(const FaultyBus&) = delete;
    FaultyBus& operator=(const FaultyBus&) = delete;

    /// Adds an end, owned by the bus. `send_only`: it does not receive.
    [[nodiscard]] End& connect(bool send_only = false) { return ends_.emplace_back(*this, send_only); }
    void set_time(antiskid::can::Time now) { now_ = now; }
    [[nodiscard]] const std::array<std::uint64_t, kFrameFaults>& fault_counts() const { return fault_counts_; }

  private:
    wear::Generator& draw_;
    std::deque<End> ends_;
    antiskid::can::Time now_{};
    std::array<std::uint64_t, kFrameFaults> fault_counts_{};
};

}  // namespace plant_sim::simulation
