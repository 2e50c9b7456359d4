#include "rig_bridge/record/work_books.hpp"

namespace rig {

Work& Work::operator+=(const Work& other) {
    brake_J += other.brake_J;
    tyre_J += other.tyre_J;
    torque_Nms += other.torque_Nms;
    sliding_torque_Nms += other.sliding_torque_Nms;
    friction_way_m += other.friction_way_m;
    return *this;
}

void WorkBooks::add(double time_s, CellReading reading, const Work& by_cells, const Work& by_speeds) {
    now_s_ = time_s;
    work_ += by_cells;
    since_knot_ += by_speeds;
    if (time_s - heard_s_ > kSilent_s) {
        silent_ = true;
        back_ = false;
    }
    if (silent_) {
        work_ = knot_;
        work_ += since_knot_;
    }
    if (reading == CellReading::none) return;
    heard_s_ = time_s;
    if (!silent_) {
        if (reading == CellReading::fresh || time_s - knot_s_ > kRepeated_s) close();
        return;
    }
    if (!back_) back_s_ = time_s;
    back_ = true;
    if (time_s - back_s_ >= kBack_s) close();
}

void WorkBooks::close() {
    closed_J_ = by_speeds_J();
    closed_s_ = silent_s();
    silent_ = back_ = false;
    knot_ = work_;
    since_knot_ = {};
    knot_s_ = now_s_;
}

}  // namespace rig
