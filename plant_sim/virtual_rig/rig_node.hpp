/// The virtual rig on a bus: sends the frames of sensors and pilot, receives the valve command, advances the plant.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "firmware/can/bus.hpp"
#include "firmware/can/layout.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/host/clock.hpp"
#include "plant_sim/study/rig_session.hpp"

namespace plant_sim {

enum class Ending {
    done,       ///< the maneuver is complete
    stopped,    ///< by the user
    silent,     ///< the controller did not answer in time
    link_down,  ///< the interface is down or gone
    /// No standstill: the controller went to its safe state, or did not stop the aircraft.
    no_standstill,
};

struct NodeResult {
    Ending ending = Ending::done;
    std::string reason;  ///< one sentence; empty for `done`
    std::uint64_t frames_sent = 0;
    std::uint64_t frames_received = 0;
    std::uint64_t frames_lost = 0;
    std::uint64_t overruns = 0;
    antiskid::control::FaultSet faults;  ///< all that the controller reported
};

/// Called after each period with the rig, the decoded status of the controller, and the current that acted.
using NodeObserver = std::function<void(const study::RigSession&, const antiskid::can::ControllerView&, double current_mA)>;

class RigNode {
  public:
    /// All arguments must outlive the node.
    RigNode(study::RigSession& session, const antiskid::can::Layout& layout, antiskid::can::Bus& bus, antiskid::host::Clock& clock,
            antiskid::control::Time period);

    /// For each sample: one SYNC, then one answer. The same seed gives the same bytes at any speed of the machine. The first cycle is repeated with
    /// the same bytes until the controller answers, at most for `start_timeout`; every later answer must come within `answer_timeout`.
    NodeResult run_lockstep(antiskid::control::Time answer_timeout, antiskid::control::Time start_timeout, const std::atomic<bool>& stop,
                            const NodeObserver& observe);

    /// In real time. The valve driver's current falls to 0 without a command for kDriverWatchdog. `start_timeout`: longest wait for a controller in
    /// standby, and longest silence of the controller after that.
    NodeResult run_realtime(antiskid::control::Time start_timeout, const std::atomic<bool>& stop, const NodeObserver& observe);

    static constexpr antiskid::control::Time kDriverWatchdog{20'000'000};

  private:
    struct Cycle;

    [[nodiscard]] Cycle next_cycle(bool with_sync);
    /// Sends all frames of a cycle, waiting for room in the queue for at most `timeout`; false if the link takes no more.
    bool send_all(const Cycle& cycle, antiskid::control::Time timeout, const std::atomic<bool>& stop);
    /// Takes all frames that have arrived; if there are none, waits for the first for at most `timeout`.
    void receive(antiskid::control::Time timeout = {});
    bool wait_for_answer(std::uint64_t answers, antiskid::control::Time timeout, const std::atomic<bool>& stop);
    NodeResult finish(Ending ending, std::string reason);
    NodeResult finish_link_down();
    NodeResult finish_run();

    study::RigSession& session_;
    const antiskid::can::Layout& layout_;
    antiskid::can::Bus& bus_;
    antiskid::host::Clock& clock_;
    antiskid::control::Time period_;
    antiskid::can::RigPort port_;
    std::uint32_t sync_ = 0;
    NodeResult result_;
};

}  // namespace plant_sim
