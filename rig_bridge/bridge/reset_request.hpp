/// When the bridge leads a tripped PLC back to `ready`.
///
/// The PLC trips whenever a bridge leaves, so that a trip alone tells nobody that something is wrong: the interlocks do. A reset is asked
/// for only while nothing is on, every interlock is good, and whoever started the bridge allows it; never during a maneuver. The PLC takes
/// its rising edge, so it is withdrawn and asked for again.
#pragma once

namespace rig::bridge {

class ResetRequest {
  public:
    /// The value of the reset command at `now_s`. `wanted`: allowed, nothing on, tripped, interlocks good.
    bool step(bool wanted, double now_s) {
        if (!wanted) {
            asking_ = false;
            waiting_ = false;
        } else if (!waiting_) {
            waiting_ = true;
            asking_ = false;
            since_s_ = now_s;
        } else if (now_s - since_s_ >= (asking_ ? kHold_s : kPause_s)) {
            asking_ = !asking_;
            since_s_ = now_s;
        }
        return asking_;
    }

  private:
    static constexpr double kPause_s = 0.1;  // longer than the PLC takes to see that it is withdrawn
    static constexpr double kHold_s = 1.0;   // longer than a commit may take
    bool waiting_ = false;
    bool asking_ = false;
    double since_s_ = 0.0;
};

}  // namespace rig::bridge
