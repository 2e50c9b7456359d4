/// The served rig on a bus, until it is stopped: sends wheel, flywheel and pressure frames, obeys the valve command. Everything else on the
/// bus is the bridge's and the controller's. Nobody's silence ends it, and no interface's: a rig stands there whoever talks to it.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

#include "firmware/can/bus.hpp"
#include "firmware/can/layout.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/host/clock.hpp"
#include "firmware/host/spsc_ring.hpp"
#include "plant_sim/plc/served_rig.hpp"
#include "rig_bridge/rig/lockstep_turn.hpp"

namespace plant_sim {

/// For whoever reports, from any thread.
struct ServeState {
    std::atomic<bool> link_up{true};
    std::atomic<bool> controller_heard{false};     ///< false: silent, its valve driver without current
    std::atomic<float> current_mA{0.0F};           ///< of the valve
    std::atomic<float> slip_reference{0.0F};       ///< as the controller last said it
    std::atomic<plc::Trip> trip{plc::Trip::none};  ///< none while the PLC is ready
    std::atomic<std::uint32_t> rejected{0};        ///< refused commit * 256 + plc::Refusal
    std::atomic<std::uint64_t> periods{0};
    std::atomic<std::uint64_t> overruns{0};  ///< periods that were not sent in time; they have passed all the same
    std::atomic<std::uint64_t> frames_lost{0};
};

/// The brake after each maneuver, for whoever keeps it: one reader.
using BrakeStates = antiskid::host::SpscRing<wear::BrakeState, 16>;

/// A bridge in lockstep, rig_bridge/rig/lockstep_turn.hpp.
struct BridgeTurns {
    std::function<std::uint16_t()> done = nullptr;  ///< the newest; none: nobody waits for a bridge
    /// Rig time begins when the bridge has joined and the controller answers; first sample and SYNC are repeated until then.
    bool together = false;
};

class ServeNode {
  public:
    /// Between two periods: registers in and out.
    using Exchange = std::function<void(plc::ServedRig&)>;

    /// All must outlive the node. `period` must be that of the rig.
    ServeNode(plc::ServedRig& rig, const antiskid::can::Layout& layout, antiskid::can::Bus& bus, antiskid::host::Clock& clock,
              antiskid::control::Time period, Exchange exchange);

    /// Paced lockstep: one sample, one SYNC, one valve command, never faster than real time; every kBridgeStep a turn of the bridge, where
    /// there is one in lockstep. Who does not answer within `answer_timeout` is silent: then periods go on in real time without waiting, until
    /// it is heard again; a controller then catches up with the SYNCs that it missed.
    void run_lockstep(const std::atomic<bool>& stop, antiskid::control::Time answer_timeout = kAnswerTimeout, BridgeTurns bridge = {});

    /// By the machine's clock.
    void run_realtime(const std::atomic<bool>& stop);

    /// Of run_realtime(): what has arrived, a period for the rig and each that was missed, and its sample.
    void period(std::uint64_t missed = 0);

    [[nodiscard]] const ServeState& state() const { return state_; }
    [[nodiscard]] BrakeStates& brake_states() { return brake_states_; }

    /// The valve's driver gives no current when no command came for so long, in rig time.
    static constexpr antiskid::control::Time kDriverWatchdog{20'000'000};
    static constexpr antiskid::control::Time kAnswerTimeout{100'000'000};
    static constexpr antiskid::control::Time kBridgeStep{10'000'000};
    /// Of the bus, after which a controller that was silent counts as caught up.
    static constexpr antiskid::control::Time kQuiet{20'000'000};

  private:
    void send_sample();
    void send_sample_and_sync(const std::atomic<bool>& stop);
    /// What has arrived; where nothing has, the first to arrive within `timeout`.
    void receive(antiskid::control::Time timeout = {});
    void await_answer(const std::atomic<bool>& stop);
    void await_bridge(const std::atomic<bool>& stop);
    void begin_together(const std::atomic<bool>& stop);
    [[nodiscard]] std::uint32_t sync_number() const;
    void catch_up(const std::atomic<bool>& stop);
    void advance();

    BrakeStates brake_states_;  // first: its lines of cache leave no gap here
    plc::ServedRig& rig_;
    antiskid::can::Bus& bus_;
    antiskid::host::Clock& clock_;
    antiskid::control::Time period_;
    antiskid::control::Time answer_timeout_ = kAnswerTimeout;
    Exchange exchange_;
    BridgeTurns bridge_;
    std::uint16_t silent_at_ = rig::kNoTurns;  // the bridge's turn when it was given up; kNoTurns: it was not
    const antiskid::can::Layout& layout_;
    antiskid::can::RigPort port_;
    std::uint32_t sync_ = 0;
    std::uint32_t commands_ = 0;  ///< valve commands that have acted
    antiskid::control::Time command_age_ = 2 * kDriverWatchdog;
    ServeState state_;
    std::uint64_t maneuvers_ = 0;  ///< of the brake
};

}  // namespace plant_sim
