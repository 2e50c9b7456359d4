/// Runs PLC client, bus recorder and main loop for any number of maneuvers. The loop keeps its step during every call, so that neither PLC nor
/// controller loses the bridge; slow work (disk, ledger) must run in meanwhile(). In lockstep the rig waits for each step, and so for slow work, up
/// to its time-out.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "firmware/host/clock.hpp"
#include "firmware/host/periodic_timer.hpp"
#include "firmware/host/stop_signals.hpp"
#include "firmware/host/supervised_can.hpp"
#include "rig_bridge/bridge/bridge_panel.hpp"
#include "rig_bridge/bridge/bridge_setup.hpp"
#include "rig_bridge/bridge/bus_recorder.hpp"
#include "rig_bridge/bridge/lockstep.hpp"
#include "rig_bridge/bridge/maneuver_record.hpp"
#include "rig_bridge/bridge/maneuver_run.hpp"
#include "rig_bridge/bridge/node.hpp"
#include "rig_bridge/bridge/terminal.hpp"
#include "rig_bridge/bridge/trace.hpp"
#include "rig_bridge/record/sample_log.hpp"
#include "rig_bridge/record/summary.hpp"

namespace rig::bridge {

struct Ran {
    record::Summary summary;
    /// Why the record is incomplete (e.g. disk full); the maneuver then does not count. Empty: it is complete.
    std::string record_error;
    Trace trace;
    std::string note;     ///< phase of the abort, and what was observed
    std::string advice;   ///< what the abort means and what to do next
    std::string outside;  ///< figures out of tolerance, with their bands
};

/// Thrown after the second Ctrl-C.
struct EndAtOnce {};

class Session {
  public:
    /// Throws std::runtime_error naming the interface, or std::invalid_argument for an invalid PLC address. `panel` may be null.
    Session(const BridgeSetup& setup, antiskid::host::StopSignals& stops, Terminal& terminal, BridgePanel* panel);
    ~Session();

    /// Waits until the brake is cold enough (or the PLC is silent), then runs the maneuver up to and including its safe end, and closes its records.
    /// Throws std::runtime_error if the record cannot be started, and EndAtOnce.
    [[nodiscard]] Ran run(const ManeuverRequest& request);

    /// After an abort, with its record closed: shows the rim speed until the rim stands, its speed is unknown or a stop is requested, then reports
    /// the state of the rim. Everything is off meanwhile.
    void watch_rim(double standstill_mps);

    /// Text on the panel between two maneuvers, e.g. who holds the campaign; empty: none.
    void rest_note(std::string note) { rest_note_ = std::move(note); }

    /// Everything is off for that long.
    void rest(antiskid::can::Time duration);

    /// Runs `work` on another thread while the loop continues; rethrows its exception.
    void meanwhile(const std::function<void()>& work);

    /// After an abort, with its record closed: runs the operator's program, if any. `outcome`: what the campaign does next, for people.
    void tell_of_abort(const Ran& ran, const std::filesystem::path& folder, const std::string& outcome);

  private:
    class ModbusPlc;
    const Moment& step(rig::Sequencer* sequencer, const ManeuverRequest* request);
    void await_ready(const ManeuverRequest& request, const ManeuverRun& run);
    void meanwhile(const std::function<void()>& work, rig::Sequencer* sequencer, const ManeuverRequest* request);
    void show(const ManeuverRequest& request, const Moment& moment, const std::string& waiting_for);
    /// Whether terminal or panel needs a new view now.
    [[nodiscard]] bool view_due(const Moment& moment, rig::Phase phase, rig::Abort abort) const;
    void present(const ViewModel& view, const Moment& moment);
    void tell_panel(const Moment& moment, bool resting);
    void sequence(const ManeuverRequest& request, ManeuverRun& run, record::SampleLog& samples);

    const BridgeSetup& setup_;
    antiskid::host::StopSignals& stops_;
    Terminal& terminal_;
    BridgePanel* panel_;
    std::string rest_note_;
    antiskid::host::MonotonicClock clock_;
    std::optional<Lockstep> lockstep_;
    std::unique_ptr<ModbusPlc> plc_;
    antiskid::host::SupervisedCan bus_;
    BusRecorder recorder_;
    Node node_;
    antiskid::host::PeriodicTimer timer_;

    // State of the running maneuver.
    bool abort_ = false;
    bool second_sender_ = false;  // has been reported
    std::string record_error_;
    std::string note_;
    std::string advice_;
    Trace trace_;
    double began_s_ = 0.0;
    double phase_began_s_ = 0.0;
    rig::Phase phase_ = rig::Phase::idle;
    rig::Abort aborted_by_ = rig::Abort::none;
};

}  // namespace rig::bridge
