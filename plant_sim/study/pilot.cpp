#include "plant_sim/study/pilot.hpp"

#include <utility>

namespace study {

namespace {
constexpr double kRounding_s = 1e-9;
}

Pilot::Pilot(ManeuverPlan plan) : plan_(std::move(plan)) {}

void Pilot::update(double time_s, bool standstill) {
    time_s_ = time_s + kRounding_s;
    if (phase_ == StopPhase::approach && time_s_ >= plan_.touchdown_s) phase_ = StopPhase::rolling;
    if (phase_ == StopPhase::rolling && time_s_ >= brake_on_s()) phase_ = StopPhase::braking;
    if (phase_ == StopPhase::braking && standstill) {
        phase_ = StopPhase::standstill;
        stood_at_s_ = time_s;
    }
    if (phase_ == StopPhase::standstill && time_s_ >= stood_at_s_ + plan_.after_standstill_s) phase_ = StopPhase::released;
    if (phase_ == StopPhase::released && time_s_ >= stood_at_s_ + plan_.after_standstill_s + plan_.release_s) phase_ = StopPhase::done;
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
    const bool brakes = phase_ == StopPhase::braking || phase_ == StopPhase::standstill;
    const bool over = phase_ == StopPhase::released || phase_ == StopPhase::done;
    return {.law = plan_.law,
            .arm = time_s_ >= plan_.arm_s && !over,
            .weight_on_wheels = phase_ != StopPhase::approach,
            .demand_Pa = brakes ? static_cast<float>(plan_.demand_Pa) : 0.0F,
            .slip_reference = static_cast<float>(plan_.slip_reference),
            .deceleration_mps2 = static_cast<float>(plan_.deceleration_mps2),
            .current_mA = brakes && plan_.law == antiskid::control::Law::open_loop ? static_cast<float>(open_loop_mA()) : 0.0F};
}

}  // namespace study
