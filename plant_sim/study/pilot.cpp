#include "plant_sim/study/pilot.hpp"

#include <utility>

namespace study {

namespace {
constexpr double kRounding_s = 1e-9;
}

const char* name(Phase phase) {
    switch (phase) {
        case Phase::approach:
            return "approach";
        case Phase::rolling:
            return "rolling";
        case Phase::braking:
            return "braking";
        case Phase::standstill:
            return "standstill";
        case Phase::released:
            return "released";
        case Phase::done:
            return "done";
    }
    return "?";
}

Pilot::Pilot(ManeuverPlan plan) : plan_(std::move(plan)) {}

void Pilot::update(double time_s, bool standstill) {
    time_s_ = time_s + kRounding_s;
    if (phase_ == Phase::approach && time_s_ >= plan_.touchdown_s) phase_ = Phase::rolling;
    if (phase_ == Phase::rolling && time_s_ >= brake_on_s()) phase_ = Phase::braking;
    if (phase_ == Phase::braking && standstill) {
        phase_ = Phase::standstill;
        stood_at_s_ = time_s;
    }
    if (phase_ == Phase::standstill && time_s_ >= stood_at_s_ + plan_.after_standstill_s) phase_ = Phase::released;
    if (phase_ == Phase::released && time_s_ >= stood_at_s_ + plan_.after_standstill_s + plan_.release_s) phase_ = Phase::done;
}

double Pilot::open_loop_mA() const {
    if (plan_.current.empty()) return 0.0;
    const double t = time_s_ - brake_on_s();
    if (t <= plan_.current.front().time_s) return plan_.current.front().current_mA;
    for (std::size_t i = 1; i < plan_.current.size(); ++i) {
        const auto& a = plan_.current[i - 1];
        const auto& b = plan_.current[i];
        if (t < b.time_s) return a.current_mA + (b.current_mA - a.current_mA) * (t - a.time_s) / (b.time_s - a.time_s);
    }
    return plan_.current.back().current_mA;
}

antiskid::can::ManeuverSample Pilot::command() const {
    const bool brakes = phase_ == Phase::braking || phase_ == Phase::standstill;
    const bool over = phase_ == Phase::released || phase_ == Phase::done;
    return {.law = plan_.law,
            .arm = time_s_ >= plan_.arm_s && !over,
            .weight_on_wheels = phase_ != Phase::approach,
            .demand_Pa = brakes ? static_cast<float>(plan_.demand_Pa) : 0.0F,
            .slip_reference = static_cast<float>(plan_.slip_reference),
            .deceleration_mps2 = static_cast<float>(plan_.deceleration_mps2),
            .current_mA = brakes && plan_.law == antiskid::control::Law::open_loop ? static_cast<float>(open_loop_mA()) : 0.0F};
}

}  // namespace study
