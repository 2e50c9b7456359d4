/// The bridge at work: PLC client, bus recorder and main loop, for as many maneuvers as wanted. While one of its calls runs, the loop keeps
/// its step, so that neither PLC nor controller takes the bridge for dead; slow work (disk, ledger) goes through meanwhile(). In lockstep
/// the rig waits for each step, and so for slow work, as long as its time-out allows.
#pragma once

#include <filesystem>
#include <functional>
#include <future>
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
    /// Why the record is not whole (the disk is full): the maneuver does not count then. Empty: it is.
    std::string record_error;
    Trace trace;
    std::string note;     ///< where it was aborted, and what was seen then
    std::string advice;   ///< what the abort means and what to do next
    std::string outside;  ///< figures out of tolerance with their bands
};

/// The second Ctrl-C.
struct EndAtOnce {};

class Session {
  public:
    /// Throws std::runtime_error naming the interface, or std::invalid_argument for a PLC address that is none.
    /// `panel`: none: there is none.
    Session(const BridgeSetup& setup, antiskid::host::StopSignals& stops, Terminal& terminal, BridgePanel* panel);
    ~Session();

    /// Waits until the brake is cold enough (or nothing is heard of the PLC), then runs the maneuver to its end, safe end included, and
    /// closes its records. Throws std::runtime_error when the record cannot be begun, EndAtOnce.
    [[nodiscard]] Ran run(const ManeuverRequest& request);

    /// After an abort, with its record closed: shows the rim's speed until it stands, until nobody knows it, or until somebody wants the
    /// program to end, and says how the rim is left. Everything is off meanwhile.
    void watch_rim(double standstill_mps);

    /// What the panel says between two maneuvers, e.g. who holds the campaign; empty: nothing.
    void rest_note(std::string note) { rest_note_ = std::move(note); }

    /// Runs `work` on another thread while the loop goes on; rethrows what it throws.
    void meanwhile(const std::function<void()>& work);

    /// After an abort, with its record closed: the operator's program, if there is one. `outcome`: what becomes of it, for people.
    void tell_of_abort(const Ran& ran, const std::filesystem::path& folder, const std::string& outcome);

  private:
    class ModbusPlc;
    const Moment& step(rig::Sequencer* sequencer, const ManeuverRequest* request);
    void await_ready(const ManeuverRequest& request, const ManeuverRun& run);
    void meanwhile(const std::function<void()>& work, rig::Sequencer* sequencer, const ManeuverRequest* request);
    void show(const ManeuverRequest& request, const Moment& moment, const std::string& waiting_for);
    /// Of whom a view is wanted now: terminal or panel.
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

    // Of the maneuver that runs.
    bool abort_ = false;
    bool second_sender_ = false;  // was named
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
