/// Listens to the rig with the pacer of the control loop, without sending: records which frames arrive, which faults the controller's input checks
/// find, and the loop's timing; then makes checks of them.
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
    std::uint32_t controller_frames = 0;  ///< frames that only another controller can have sent
    can::LinkStatus link;
    /// Periods in which each fault was present, without those of the first kSettle, before frames have arrived.
    std::array<std::uint64_t, control::kFaultCount> fault_periods{};
    control::Sensors sensors;  ///< newest
    float wheel_radps = 0.0F;  ///< largest after kSettle
    float flywheel_radps = 0.0F;
    float pressure_Pa = 0.0F;  ///< reading with the largest magnitude after kSettle

    static constexpr control::Time kSettle{500'000'000};  ///< longer than every age limit of the inputs

    [[nodiscard]] const can::MessageStats& of(can::Role role) const { return stats[static_cast<std::size_t>(role)]; }
    [[nodiscard]] bool faulty(control::Fault fault) const { return fault_periods[static_cast<std::size_t>(fault)] > 0; }
};

/// A bus that counts frames of the controller's messages sent by another node.
class ListeningBus final : public can::Bus {
  public:
    /// Both must outlive this object.
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

/// Run it on a thread with the loop's scheduling. Listens for `duration`, at least one period, or until `stop`.
[[nodiscard]] Reception listen(const controller::ControllerSetup& setup, can::Bus& bus, host::Clock& clock, control::Time duration,
                               const std::atomic<bool>& stop);

/// Checks that each message needed by the controller is present, fresh, undamaged and plausible; and the sensors' values at rest, the link, and that
/// there is no second controller. Missing messages of the bridge are only a warning.
[[nodiscard]] Checks frame_checks(const Reception& reception, const controller::ControllerSetup& setup, const std::string& interface);
/// The same checks as skipped, if the bus could not be opened.
[[nodiscard]] Checks frame_checks_skipped(const controller::ControllerSetup& setup, const std::string& why);

/// Latency, work and missed periods of the loop.
[[nodiscard]] Checks timing_checks(const Reception& reception, control::Time period);

/// Why the valve must not be moved now; empty if it may: wheel and flywheel at rest, no pressure, every sensor good, no other controller.
[[nodiscard]] std::string why_not_to_move_the_valve(const Reception& reception, const control::Config& config);

}  // namespace antiskid::controller
