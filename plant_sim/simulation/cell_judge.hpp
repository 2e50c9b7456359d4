/// Invariants of a cell in every period, whatever fails in it.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "firmware/can/observer.hpp"
#include "plant_sim/plc/served_rig.hpp"
#include "plant_sim/simulation/cell_campaign.hpp"
#include "rig_bridge/rig/sequencer.hpp"

namespace plant_sim::simulation {

/// Time at which the controller last got the permission to brake, by the frames that it received undamaged.
class Permission {
  public:
    explicit Permission(const antiskid::can::Layout& layout) : layout_(layout), heard_(layout) {}

    void accept(const antiskid::can::Frame& frame) {
        if (frame.id != layout_[antiskid::can::Role::maneuver].id && frame.id != layout_[antiskid::can::Role::emergency_stop].id) return;
        const auto role = heard_->accept(frame);
        if (role == antiskid::can::Role::emergency_stop) stopped_ = true;
        if (role != antiskid::can::Role::maneuver) return;
        const bool arm = heard_->view().maneuver.arm;
        if (!arm) stopped_ = false;
        if (arm && !stopped_) granted_ = frame.received;
    }
    /// Call when a program at either end restarts: any alive counter is then accepted.
    void reset() { heard_.emplace(layout_); }
    [[nodiscard]] antiskid::control::Time granted() const { return granted_; }

  private:
    const antiskid::can::Layout& layout_;
    std::optional<antiskid::can::Observer> heard_;
    bool stopped_ = false;
    antiskid::control::Time granted_{0};
};

/// State of one period.
struct CellNow {
    antiskid::control::Time now{};
    bool loop_lives = false;  ///< the bridge's main loop runs
    bool plc_reachable = false;
    bool plc_frozen = false;
    bool controller_lives = false;
    unsigned open = 0;                          ///< open interlocks, as bits
    const rig::Sequencer* sequencer = nullptr;  ///< null: no maneuver is running
};

class CellJudge {
  public:
    using Sink = std::function<void(const std::string&)>;

    /// All arguments must outlive it. `violated` gets a line for each violation.
    CellJudge(const CellSetup& setup, const rig::Plan& plan, const plc::ServedRig& rig, Sink violated);

    /// Call for each undamaged frame that the controller, or the rig, receives.
    void controller_received(const antiskid::can::Frame& frame) { permission_.accept(frame); }
    void rig_received(const antiskid::can::Frame& frame);
    /// Call when bridge or controller restarts.
    void restarted() { permission_.reset(); }

    void check(const CellNow& cell);
    void begun() { touchdowns_ = rig_.maneuvers(); }
    void over(const rig::Sequencer& sequencer);

  private:
    void machines(const CellNow& cell);

    const CellSetup& setup_;
    const rig::Plan& plan_;
    const plc::ServedRig& rig_;
    Sink violated_;
    Permission permission_;
    antiskid::can::Observer valve_;
    double top_mps_;
    std::uint32_t touchdowns_ = 0;
    unsigned open_ = 0;
    bool written_ = false;
    antiskid::control::Time opened_{}, bridge_seen_{}, plc_answered_{}, controller_lived_{};
};

}  // namespace plant_sim::simulation
