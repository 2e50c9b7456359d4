#include "plant_sim/progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "firmware/can/value_names.hpp"

namespace plant_sim {

namespace {

/// Speed lost so far, as a bar.
std::string bar(double share) {
    constexpr int kWidth = 24;
    const int full = static_cast<int>(std::clamp(share, 0.0, 1.0) * kWidth);
    return std::string(static_cast<std::size_t>(full), '#') +
           std::string(static_cast<std::size_t>(kWidth - full), '.');
}

}  // namespace

Progress::Progress() : terminal_(::isatty(STDERR_FILENO) == 1) {}

void Progress::show(const study::RigSession& session, const antiskid::can::ControllerView& controller) {
    constexpr double kLive_s = 0.05;
    constexpr double kPlain_s = 1.0;
    const plant::Rig& rig = session.rig();
    const study::Phase phase = session.pilot().phase();
    if (rig.time_s() < next_s_ && phase == phase_) return;
    phase_ = phase;
    next_s_ = rig.time_s() + (terminal_ ? kLive_s : kPlain_s);
    const double share = 1.0 - rig.wheel().v_mps / rig.parameters().brake_on_mps;
    fmt::print(stderr, "{}[{}] {:6.2f} s {:<10} {:5.1f} m/s  slip {:5.2f}  {:5.1f} MPa  {:7.1f} m  {}{}",
               terminal_ ? "\r" : "", bar(share), rig.time_s(), study::name(phase), rig.wheel().v_mps,
               rig.forces().slip, rig.pressure_Pa() * 1e-6, session.distance_m(),
               antiskid::can::kStateNames[static_cast<std::size_t>(controller.state)],
               terminal_ ? "\x1b[K" : "\n");
    std::fflush(stderr);
    shown_ = true;
}

void Progress::finish() {
    if (terminal_ && shown_) fmt::print(stderr, "\n");
}

}  // namespace plant_sim
