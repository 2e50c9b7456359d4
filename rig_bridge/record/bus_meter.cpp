#include "rig_bridge/record/bus_meter.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/can/roles.hpp"

namespace rig {

using antiskid::can::Role;
using antiskid::control::kNever;

namespace {

ShaftSample shaft(const antiskid::control::SpeedInput& input, const antiskid::can::SpeedSignals& signals,
                  bool reported) {
    return {.edges = input.source == antiskid::control::SpeedSource::edges,
            .edge_count = input.edge_count,
            .edge_time = input.edge_time,
            .speed_radps = static_cast<double>(input.speed_radps),
            .roll_over = {.count_mask = static_cast<std::uint32_t>(signals.edge_count.mask()),
                          .time = Time{std::llround((static_cast<double>(signals.edge_time.mask()) + 1.0) *
                                                    signals.edge_time.scale)}},
            .reported = reported};
}

}  // namespace

BusMeter::BusMeter(const antiskid::can::Layout& layout, const MeterParameters& parameters)
    : layout_(layout), period_s_(parameters.period_s), observer_(layout), meter_(parameters) {}

void BusMeter::accept(const antiskid::can::Frame& frame) {
    const auto role = observer_.accept(frame);
    if (!role) return;
    wheel_reported_ = wheel_reported_ || *role == Role::wheel;
    flywheel_reported_ = flywheel_reported_ || *role == Role::flywheel;
    load_cells_reported_ = load_cells_reported_ || *role == Role::load_cells;
    // Until spin-up ends with arming, the controller still names what an earlier maneuver left.
    constexpr std::uint8_t kSpinUp = 1;
    if (*role == Role::faults && view().maneuver_state.phase > kSpinUp)
        faults_.insert(view().controller.faults);
    if (*role == Role::sync) {
        count_sync();
    } else if (*role == Role::pressure && !sync_) {
        const std::int64_t us = frame.received.count() / 1000;
        if (!stamped_) first_us_ = newest_us_ = us;
        stamped_ = true;
        if (us < newest_us_) {
            // From here on the stamps run on from where they had been.
            first_us_ -= newest_us_ - us;
            ++steps_back_;
        }
        newest_us_ = us;
        sample(static_cast<double>(us - first_us_) * 1e-6);
    }
}

/// The number has no CRC: a leap counts once the next number goes on from it.
void BusMeter::count_sync() {
    const std::uint32_t number = view().sync_number;
    const antiskid::can::Signal& counter = layout_.sync_counter;
    std::uint64_t passed = 1;
    if (sync_ && counter.bound()) {
        const std::uint64_t mask = counter.mask();
        passed = (number - last_sync_) & mask;
        if (passed == 0) return;  // the same sample said twice
        constexpr std::uint64_t kLeap = 8;
        const bool goes_on = leapt_to_ && ((number - *leapt_to_) & mask) == 1;
        leapt_to_.reset();
        if (passed > kLeap && !goes_on) {
            leapt_to_ = number;
            return;
        }
        if (passed > mask / 2) passed = 1;  // the rig counts anew
    }
    sync_ = true;
    last_sync_ = number;
    syncs_ += passed;
    sample(static_cast<double>(syncs_) * period_s_);
}

void BusMeter::sample(double time_s) {
    const antiskid::can::BusView& v = view();
    if (v.wheel.received == kNever || v.flywheel.received == kNever || v.pressure.received == kNever) return;
    meter_.feed({.time_s = time_s,
                 .phase = v.maneuver_state.phase,
                 .wheel = shaft(v.wheel, layout_.wheel, wheel_reported_),
                 .flywheel = shaft(v.flywheel, layout_.flywheel, flywheel_reported_),
                 .pressure_Pa = static_cast<double>(v.pressure.pressure_Pa),
                 .vertical_N = static_cast<double>(v.load_cells.vertical_N),
                 .longitudinal_N = static_cast<double>(v.load_cells.longitudinal_N),
                 .brake_torque_Nm = static_cast<double>(v.load_cells.brake_torque_Nm),
                 .load_cells_reported = load_cells_reported_ || v.load_cells_received == kNever,
                 .brake_temperature_C = static_cast<double>(v.maneuver_state.brake_temperature_C)});
    wheel_reported_ = flywheel_reported_ = load_cells_reported_ = false;
}

std::uint64_t BusMeter::frames_lost() const {
    std::uint64_t lost = 0;
    for (const Role role : antiskid::can::kEveryRole) lost += observer_.stats(role).lost;
    return lost;
}

}  // namespace rig
