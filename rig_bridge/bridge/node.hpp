/// One 10 ms step of the bridge's main loop: reads PLC and bus, steps the sequencer, commands PLC and controller. Independent of threads, files and
/// clocks; the step's time is passed in.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "firmware/can/bus.hpp"
#include "firmware/can/rig_port.hpp"
#include "rig_bridge/bridge/plc_and_bus.hpp"
#include "rig_bridge/bridge/reset_request.hpp"
#include "rig_bridge/bridge/rig_time.hpp"
#include "rig_bridge/bridge/translate.hpp"
#include "rig_bridge/rig/sequencer.hpp"

namespace rig::bridge {

/// Inputs and decisions of one step.
struct Moment {
    antiskid::can::Time now{};  ///< steady clock
    double rig_s = 0.0;         ///< see RigTime
    modbus::Snapshot plc;
    BusNow bus;
    rig::Inputs inputs;
    rig::Outputs outputs;
    bool resetting = false;
};

class Node {
  public:
    static constexpr antiskid::can::Time kStep{10'000'000};

    /// All must outlive the node. `period_s`: control period, the step of the SYNC number.
    Node(const antiskid::can::Layout& layout, double period_s, const Freshness& limits, Plc& plc, const BusFeed& feed, antiskid::can::Bus& bus);

    struct Wishes {
        std::int64_t number = 0;  ///< of the maneuver, for the bus
        bool abort = false;
        bool reset = false;  ///< reset a tripped PLC while nothing is on
    };
    /// Makes one step at `now`. Null `sequencer`: everything is off and the phase is `idle`.
    const Moment& step(rig::Sequencer* sequencer, const Wishes& wishes, antiskid::can::Time now);

    [[nodiscard]] const Moment& moment() const { return moment_; }
    [[nodiscard]] const Freshness& limits() const { return limits_; }

  private:
    void send(std::int64_t number);
    void send_load_cells();
    [[nodiscard]] bool command_waits(std::span<const antiskid::can::Frame> due) const;
    [[nodiscard]] bool nothing_on() const;

    const antiskid::can::Layout& layout_;
    Freshness limits_;
    Plc& plc_;
    const BusFeed& feed_;
    antiskid::can::Bus& bus_;
    antiskid::can::RigPort port_;
    RigTime time_;
    ResetRequest reset_;
    Moment moment_;
    rig::Phase sent_phase_ = rig::Phase::idle;  // phase in the newest command
    std::uint64_t steps_ = 0;
    std::uint64_t load_cell_steps_ = 1;
    std::uint64_t foreign_commands_ = 0;  // at the last step
    std::optional<antiskid::can::LoadCellSample> sent_reading_;
    double sent_watchdog_ = 0.0;
};

}  // namespace rig::bridge
