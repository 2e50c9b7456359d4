/// Decides when the bridge resets a tripped PLC to `ready`.
///
/// The PLC trips whenever a bridge ends, so that a trip alone indicates no problem; an open interlock does. A reset is requested only if nothing is
/// on, every interlock is good and the operator allows it; never during a maneuver. The PLC acts on the rising edge, so the request is withdrawn and
/// repeated.
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
    static constexpr double kPause_s = 0.1;  // longer than the PLC needs to see the withdrawal
    static constexpr double kHold_s = 1.0;   // longer than a commit may take
    bool waiting_ = false;
    bool asking_ = false;
    double since_s_ = 0.0;
};

}  // namespace rig::bridge
