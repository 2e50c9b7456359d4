#include "plant_sim/study/session_lanes.hpp"

namespace study {

void SessionLanes::place(std::size_t lane, RigSession* session) {
    sessions_[lane] = session;
    rigs_.place(lane, session != nullptr ? &session->rig_ : nullptr);
}

void SessionLanes::advance(const std::array<Period, kLanes>& periods) {
    std::array<double, kLanes> current_mA{};
    for (std::size_t i = 0; i < kLanes; ++i) current_mA[i] = periods[i].current_mA;
    rigs_.advance_current(current_mA);
    for (std::size_t i = 0; i < kLanes; ++i) {
        if (sessions_[i] == nullptr) continue;
        sessions_[i]->meter_.command(periods[i].current_mA);
        sessions_[i]->measure();
        sessions_[i]->close_period(periods[i].controller);
    }
}

}  // namespace study
