/// One maneuver as the main loop runs it: the wait before it, its sequence, and when its record ends. Pure: moments in, decisions out; knows no
/// thread, clock or terminal.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "rig_bridge/bridge/node.hpp"
#include "rig_bridge/record/bus_log.hpp"
#include "rig_bridge/record/sample_log.hpp"
#include "rig_bridge/rig/sequencer.hpp"

namespace rig::bridge {

class ManeuverRun {
  public:
    /// `now_s`: Moment::rig_s when its wait begins.
    ManeuverRun(const rig::Plan& plan, double now_s) : plan_(plan), began_s_(now_s) {}

    /// After a step without a sequencer, whether begin() may follow: the controller knows the bridge, and the brake is cold, or did not cool in time,
    /// or nothing is heard of the PLC; then the sequencer says so.
    [[nodiscard]] bool ready(const Moment& moment) const;
    /// For people; empty while the bridge makes itself known.
    [[nodiscard]] std::string waits_for(const Moment& moment) const;

    void begin() { sequencer_.emplace(plan_); }
    /// For each step; none before begin().
    [[nodiscard]] rig::Sequencer* sequencer() { return sequencer_ ? &*sequencer_ : nullptr; }
    [[nodiscard]] const rig::Sequencer* sequencer() const { return sequencer_ ? &*sequencer_ : nullptr; }

    /// After each step: what is new of the PLC goes into `samples`, stamped `at`, while the record lasts. True: it ends with this step.
    bool follow(const Moment& moment, antiskid::can::Time at, record::SampleLog& samples);
    /// The record goes on; its end is some steps after that of the sequence, so that it has the last phase.
    [[nodiscard]] bool recording() const { return sequencer_ && resting_ <= kTail; }
    [[nodiscard]] bool over() const { return sequencer_ && sequencer_->over() && resting_ > kTail; }

    /// Waits for the disk.
    void finish(record::BusLog& log, record::SampleLog& samples);
    /// Why the record is not whole; empty: it is. The next step is to abort then.
    [[nodiscard]] const std::string& record_error() const { return record_error_; }

  private:
    static constexpr int kTail = 15;  // steps
    [[nodiscard]] double waited_s(const Moment& moment) const { return moment.rig_s - began_s_; }

    rig::Plan plan_;
    double began_s_;
    std::optional<rig::Sequencer> sequencer_;
    std::uint64_t polls_ = 0;
    int resting_ = 0;  // steps
    std::string record_error_;
};

}  // namespace rig::bridge
