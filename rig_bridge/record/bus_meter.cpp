#include "rig_bridge/record/bus_meter.hpp"

#include <fmt/format.h>

#include <cmath>

#include "firmware/can/roles.hpp"
#include "firmware/host/seconds.hpp"

namespace rig::record {

using antiskid::can::Role;
using antiskid::control::kNever;

namespace {

ShaftSample shaft(const antiskid::control::SpeedInput& input, const antiskid::can::SpeedSignals& signals, bool reported) {
    return {.edges = input.source == antiskid::control::SpeedSource::edges,
            .edge_count = input.edge_count,
            .edge_time = input.edge_time,
            .speed_radps = static_cast<double>(input.speed_radps),
            .roll_over = {.count_mask = static_cast<std::uint32_t>(signals.edge_count.mask()),
                          .time = Time{std::llround((static_cast<double>(signals.edge_time.mask()) + 1.0) * signals.edge_time.scale)}},
            .reported = reported};
}

}  // namespace

BusMeter::BusMeter(const antiskid::can::Layout& layout, const MeterParameters& parameters)
    : layout_(layout), samples_(layout, parameters.period_s), meter_(parameters) {}

void BusMeter::accept(const antiskid::can::Frame& frame) {
    constexpr std::uint8_t kSpinUp = 1, kBraking = 4;  // codes of antiskid::can::kPhaseNames
    const auto role = samples_.accept(frame);
    const antiskid::can::BusView& v = view();
    wheel_reported_ = wheel_reported_ || role == Role::wheel;
    flywheel_reported_ = flywheel_reported_ || role == Role::flywheel;
    load_cells_reported_ = load_cells_reported_ || role == Role::load_cells;
    braked_ = braked_ || (role == Role::maneuver_state && v.maneuver_state.phase == kBraking);
    // Until spin-up ends with arming, the controller still reports the faults of an earlier maneuver.
    if (role == Role::faults && v.maneuver_state.phase > kSpinUp) faults_.insert(v.controller.faults);
    if (!samples_.ended()) return;
    meter_.feed({.time_s = samples_.time_s(),
                 .phase = v.maneuver_state.phase,
                 .braked = braked_,
                 .wheel = shaft(v.wheel, layout_.wheel, wheel_reported_),
                 .flywheel = shaft(v.flywheel, layout_.flywheel, flywheel_reported_),
                 .pressure_Pa = static_cast<double>(v.pressure.pressure_Pa),
                 .vertical_N = static_cast<double>(v.load_cells.vertical_N),
                 .longitudinal_N = static_cast<double>(v.load_cells.longitudinal_N),
                 .brake_torque_Nm = static_cast<double>(v.load_cells.brake_torque_Nm),
                 .load_cells_age_s = antiskid::host::seconds(v.load_cells.age),
                 .load_cells_reported = load_cells_reported_ || v.load_cells_received == kNever,
                 .brake_temperature_C = static_cast<double>(v.maneuver_state.brake_temperature_C)});
    wheel_reported_ = flywheel_reported_ = load_cells_reported_ = braked_ = false;
}

std::vector<std::string> BusMeter::warnings() const {
    std::vector<std::string> all = meter_.warnings();
    if (open()) all.push_back(fmt::format("ends_unheard: at {:.1f} m/s, {}", meter_.speed_mps(), in_no_record(meter_.kinetic_energy_J())));
    return all;
}

std::uint64_t BusMeter::frames_lost() const {
    std::uint64_t lost = 0;
    for (const Role role : antiskid::can::kEveryRole) lost += samples_.observer().stats(role).lost;
    return lost;
}

}  // namespace rig::record
