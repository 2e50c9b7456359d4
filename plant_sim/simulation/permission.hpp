/// Time at which the controller last got the permission to brake, by the frames that it received undamaged.
#pragma once

#include <optional>

#include "firmware/can/observer.hpp"

namespace plant_sim::simulation {

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

}  // namespace plant_sim::simulation
