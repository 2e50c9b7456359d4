/// One maneuver in the main loop: the wait before it, its sequence, and the end of its record. Pure: moments in, decisions out; independent of
/// threads, clocks and terminal.
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
    /// `now_s`: Moment::rig_s at the beginning of the wait.
    ManeuverRun(const rig::Plan& plan, double now_s) : plan_(plan), began_s_(now_s) {}

    /// After a step without a sequencer, whether begin() may follow: the controller receives the bridge, and the brake is cold. Also true if the
    /// brake does not cool in time or the PLC is silent; the sequencer then reports that.
    [[nodiscard]] bool ready(const Moment& moment) const;
    /// What is waited for, for people; empty while the controller does not yet receive the bridge.
    [[nodiscard]] std::string waits_for(const Moment& moment) const;

    void begin() { sequencer_.emplace(plan_); }
    /// To pass to each step; null before begin().
    [[nodiscard]] rig::Sequencer* sequencer() { return sequencer_ ? &*sequencer_ : nullptr; }
    [[nodiscard]] const rig::Sequencer* sequencer() const { return sequencer_ ? &*sequencer_ : nullptr; }

    /// Call after each step: writes new PLC values to `samples`, stamped `at`, while recording. True if the record ends with this step.
    bool follow(const Moment& moment, antiskid::can::Time at, record::SampleLog& samples);
    /// Whether the record continues; it ends some steps after the sequence, so that it includes the last phase.
    [[nodiscard]] bool recording() const { return sequencer_ && resting_ <= kTail; }
    [[nodiscard]] bool over() const { return sequencer_ && sequencer_->over() && resting_ > kTail; }

    /// Finishes both files; waits for the disk.
    void finish(record::BusLog& log, record::SampleLog& samples);
    /// Why the record is incomplete; the next step must then abort. Empty: it is complete.
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
