/// The served rig on a bus, until it is stopped: sends frames of wheel, flywheel and pressure, receives the valve command. All other frames are the
/// bridge's and the controller's. Neither a silent program nor a lost interface ends it.
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

/// State for reporting; may be read by any thread.
struct ServeState {
    std::atomic<bool> link_up{true};
    std::atomic<bool> controller_heard{false};     ///< false: silent, and the valve driver's current is 0
    std::atomic<float> current_mA{0.0F};           ///< of the valve
    std::atomic<float> slip_reference{0.0F};       ///< the newest of the controller
    std::atomic<plc::Trip> trip{plc::Trip::none};  ///< none while the PLC is ready
    std::atomic<std::uint32_t> rejected{0};        ///< rejected commit * 256 + plc::Rejection
    std::atomic<std::uint64_t> periods{0};
    std::atomic<std::uint64_t> overruns{0};  ///< periods that were not sent in time; the rig has advanced by them
    std::atomic<std::uint64_t> frames_lost{0};
};

/// The brake's state after each maneuver, for one reader.
using BrakeStates = antiskid::host::SpscRing<wear::BrakeState, 16>;

/// A bridge in lockstep, see rig_bridge/rig/lockstep_turn.hpp.
struct LockstepBridge {
    std::function<std::uint16_t()> done = nullptr;  ///< number of the bridge's newest turn; empty function: no bridge is waited for
    /// Whether rig time begins only when the bridge has joined and the controller answers; first sample and SYNC are repeated until then.
    bool start_together = false;
};

class ServeNode {
  public:
    /// Called between two periods: reads and writes the registers.
    using Exchange = std::function<void(plc::ServedRig&)>;

    /// All arguments must outlive the node. `period`: the rig's.
    ServeNode(plc::ServedRig& rig, const antiskid::can::Layout& layout, antiskid::can::Bus& bus, antiskid::host::Clock& clock,
              antiskid::control::Time period, Exchange exchange);

    /// Lockstep, not faster than real time: one sample, one SYNC, one valve command; every kBridgeStep one turn of the bridge, if it is in lockstep.
    /// A program that does not answer within `answer_timeout` is silent: periods then go on in real time without waiting for it, until it sends
    /// again. A controller then catches up with the SYNCs that it missed.
    void run_lockstep(const std::atomic<bool>& stop, antiskid::control::Time answer_timeout = kAnswerTimeout, LockstepBridge bridge = {});

    /// In real time.
    void run_realtime(const std::atomic<bool>& stop);

    /// One iteration of run_realtime(): takes the frames that have arrived, advances the rig by one period and the `missed` ones, sends the sample.
    void period(std::uint64_t missed = 0);

    [[nodiscard]] const ServeState& state() const { return state_; }
    [[nodiscard]] BrakeStates& brake_states() { return brake_states_; }

    /// Rig time without a command after which the valve driver's current falls to 0.
    static constexpr antiskid::control::Time kDriverWatchdog{20'000'000};
    static constexpr antiskid::control::Time kAnswerTimeout{100'000'000};
    static constexpr antiskid::control::Time kBridgeStep{10'000'000};
    /// Time without frames on the bus after which a controller that was silent counts as caught up.
    static constexpr antiskid::control::Time kQuiet{20'000'000};

  private:
    void send_sample();
    void send_sample_and_sync(const std::atomic<bool>& stop);
    /// Takes all frames that have arrived; if there are none, waits for the first for at most `timeout`.
    void receive(antiskid::control::Time timeout = {});
    void await_answer(const std::atomic<bool>& stop);
    void await_bridge(const std::atomic<bool>& stop);
    void begin_together(const std::atomic<bool>& stop);
    [[nodiscard]] std::uint32_t sync_number() const;
    void catch_up(const std::atomic<bool>& stop);
    void advance();

    BrakeStates brake_states_;  // first member: its alignment to cache lines leaves no gap here
    plc::ServedRig& rig_;
    antiskid::can::Bus& bus_;
    antiskid::host::Clock& clock_;
    antiskid::control::Time period_;
    antiskid::control::Time answer_timeout_ = kAnswerTimeout;
    Exchange exchange_;
    LockstepBridge bridge_;
    std::uint16_t silent_at_ = rig::kNoTurns;  // turn of the bridge at which it was given up; kNoTurns: it was not
    const antiskid::can::Layout& layout_;
    antiskid::can::RigPort port_;
    std::uint32_t sync_ = 0;
    std::uint32_t commands_ = 0;  ///< number of valve commands that have acted
    antiskid::control::Time command_age_ = 2 * kDriverWatchdog;
    ServeState state_;
    std::uint64_t maneuvers_ = 0;  ///< of the brake
};

}  // namespace plant_sim
