/// Rig time: counted in control periods by SYNC frames if there are any, else by the machine's clock.
#pragma once

#include <cstdint>

namespace rig::bridge {

class RigTime {
  public:
    /// `sync_timeout_s`: after this time without SYNC the machine's clock is used again.
    explicit RigTime(double period_s, double sync_timeout_s = 0.2) : period_s_(period_s), sync_timeout_s_(sync_timeout_s) {}

    /// Rig time, s. Neither argument may decrease; `syncs`: SYNC frames so far.
    double at(double wall_s, std::uint64_t syncs) {
        if (!started_) {
            started_ = true;
            wall_s_ = wall_s;
            syncs_ = syncs;
        }
        if (syncs != syncs_) {
            rig_s_ += static_cast<double>(syncs - syncs_) * period_s_;
            syncs_ = syncs;
            heard_ = true;
            heard_s_ = wall_s;
        } else if (!heard_ || wall_s - heard_s_ > sync_timeout_s_) {
            rig_s_ += wall_s - wall_s_;
        }
        wall_s_ = wall_s;
        return rig_s_;
    }

  private:
    double period_s_;
    double sync_timeout_s_;
    bool started_ = false;
    bool heard_ = false;
    double heard_s_ = 0.0;
    double wall_s_ = 0.0;
    double rig_s_ = 0.0;
    std::uint64_t syncs_ = 0;
};

}  // namespace rig::bridge
