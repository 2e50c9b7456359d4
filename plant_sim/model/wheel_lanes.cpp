#include "plant_sim/model/wheel_lanes.hpp"

namespace plant {

namespace {

[[gnu::always_inline]] inline void turn_all(WheelLanes& lanes) {
    for (std::size_t i = 0; i < WheelLanes::kLanes; ++i) {
        const wheel_step::Law law = lanes.laws[i];
        const WheelLanes::Input at = lanes.inputs[i];
        const wheel_step::Instant start =
            wheel_step::instant(law, at.v_mps, at.omega_radps, at.load.base_at(0.0), at.load.change_N / at.h, at.load.lift_Ns2pm2);
        lanes.steps.set(i, wheel_step::turn(law, start, at.pressure, at.load, at.h));
    }
}

#if defined(__x86_64__)
[[gnu::target("avx512f,avx512dq,avx512vl")]] void turn_avx512(WheelLanes& lanes) {
    turn_all(lanes);
}
[[gnu::target("avx2")]] void turn_avx2(WheelLanes& lanes) {
    turn_all(lanes);
}
#endif

}  // namespace

bool WheelLanes::has(Instructions instructions) {
    if (instructions == Instructions::baseline) return true;
#if defined(__x86_64__)
    if (instructions == Instructions::avx2) return __builtin_cpu_supports("avx2") != 0;
    return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
#else
    return false;
#endif
}

void WheelLanes::turn(Instructions instructions) {
#if defined(__x86_64__)
    if (instructions == Instructions::avx512) return turn_avx512(*this);
    if (instructions == Instructions::avx2) return turn_avx2(*this);
#endif
    turn_all(*this);
}

void WheelLanes::turn() {
    if (has(Instructions::avx512)) return turn(Instructions::avx512);
    turn(has(Instructions::avx2) ? Instructions::avx2 : Instructions::baseline);
}

}  // namespace plant
