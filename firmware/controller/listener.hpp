/// Hears the rig as the controller would, by the very pacer of its loop, and sends nothing: which frames come, what the controller's own
/// input checks say of them, and how punctual the loop is. Then judges it.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>

#include "firmware/can/bus.hpp"
#include "firmware/can/controller_port.hpp"
#include "firmware/can/message_stats.hpp"
#include "firmware/control/types.hpp"
#include "firmware/controller/check.hpp"
#include "firmware/controller/controller_setup.hpp"
#include "firmware/host/clock.hpp"
#include "firmware/host/histogram.hpp"

namespace antiskid::controller {

struct Reception {
    std::uint64_t periods = 0;
    std::uint64_t missed_periods = 0;
    host::Histogram latency;  ///< from the deadline to the loop running
    host::Histogram work;     ///< from there to the command

    std::array<can::MessageStats, can::kRoleCount> stats{};
    std::uint32_t controller_frames = 0;  ///< that only another controller can have sent
    can::LinkStatus link;
    /// Periods in which each fault was present. Those of the first kSettle do not count: nothing has arrived yet.
    std::array<std::uint64_t, control::kFaultCount> fault_periods{};
    control::Sensors sensors;  ///< newest
    float wheel_radps = 0.0F;  ///< largest after kSettle
    float flywheel_radps = 0.0F;
    float pressure_Pa = 0.0F;  ///< the one furthest from 0 after kSettle

    static constexpr control::Time kSettle{500'000'000};  ///< beyond every age limit

    [[nodiscard]] const can::MessageStats& of(can::Role role) const { return stats[static_cast<std::size_t>(role)]; }
    [[nodiscard]] bool faulty(control::Fault fault) const { return fault_periods[static_cast<std::size_t>(fault)] > 0; }
};

/// A bus that takes note of the controller's own frames when somebody else sends them.
class ListeningBus final : public can::Bus {
  public:
    /// Both must outlive it.
    ListeningBus(can::Bus& bus, const can::Layout& layout) : bus_(bus), layout_(layout) {}
    std::size_t receive(std::span<can::Frame> frames) override;
    bool send(const can::Frame& frame) override { return bus_.send(frame); }
    bool wait(can::Time timeout) override { return bus_.wait(timeout); }
    [[nodiscard]] can::LinkStatus status() const override { return bus_.status(); }
    [[nodiscard]] std::uint32_t controller_frames() const { return controller_frames_; }

  private:
    can::Bus& bus_;
    const can::Layout& layout_;
    std::uint32_t controller_frames_ = 0;
};

/// For the loop's own thread, with its rights. `duration`: of listening, from one period to all that `stop` allows.
[[nodiscard]] Reception listen(const controller::ControllerSetup& setup, can::Bus& bus, host::Clock& clock, control::Time duration,
                               const std::atomic<bool>& stop);

/// Present, fresh, undamaged, plausible: a check for each message that the controller lives on, one for what the sensors say while the
/// rig is at rest, one for the link, one for a second controller. What the bridge sends may be absent: a warning.
[[nodiscard]] Checks frame_checks(const Reception& reception, const controller::ControllerSetup& setup, const std::string& interface);
/// The same, where nothing could be heard: all skipped.
[[nodiscard]] Checks frame_checks_skipped(const controller::ControllerSetup& setup, const std::string& why);

/// Latency, work and missed periods of the loop.
[[nodiscard]] Checks timing_checks(const Reception& reception, control::Time period);

/// Why the valve may not be moved now; empty: wheel and flywheel at rest, no pressure, every sensor good, nobody else commands.
[[nodiscard]] std::string why_not_to_move_the_valve(const Reception& reception, const control::Config& config);

}  // namespace antiskid::controller
