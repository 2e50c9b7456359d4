#include "rig_bridge/record/work_balance.hpp"

namespace rig::record {

Work& Work::operator+=(const Work& other) {
    brake_J += other.brake_J;
    tyre_J += other.tyre_J;
    torque_Nms += other.torque_Nms;
    sliding_torque_Nms += other.sliding_torque_Nms;
    friction_way_m += other.friction_way_m;
    return *this;
}

bool WorkBalance::add(double time_s, CellReading reading, const Work& by_cells, const Work& by_speeds, const WorkAhead& ahead) {
    now_s_ = time_s;
    ahead_ = ahead;
    since_knot_ += by_speeds;
    if (time_s - heard_s_ > kSilent_s) {
        silent_ = true;
        back_ = false;
    }
    work_ = knot_;
    work_ += silent_ ? since_knot_ : by_cells;
    if (reading == CellReading::none) return false;
    heard_s_ = time_s;
    if (!silent_) return (reading == CellReading::fresh || time_s - knot_s_ > kRepeated_s) && close();
    if (!back_) back_s_ = time_s;
    back_ = true;
    return time_s - back_s_ >= kBack_s && close();
}

Work WorkBalance::work() const {
    Work work = work_;
    work += silent_ ? ahead_.by_speeds : ahead_.by_cells;
    return work;
}

Work WorkBalance::by_speeds() const {
    Work work = closed_;
    if (silent_) {
        work += since_knot_;
        work += ahead_.by_speeds;
    }
    return work;
}

bool WorkBalance::close() {
    if (silent_) closed_ += since_knot_;
    closed_s_ = silent_s();
    silent_ = back_ = false;
    knot_ = work_;
    since_knot_ = {};
    knot_s_ = now_s_;
    return true;
}

}  // namespace rig::record
