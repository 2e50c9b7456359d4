#include "rig_bridge/replay/maneuver_writer.hpp"

#include <cmath>
#include <stdexcept>

#include "firmware/can/roles.hpp"

namespace rig::replay {

using antiskid::can::Frame;
using antiskid::can::RigPort;
using antiskid::can::Role;
using antiskid::can::Time;

namespace {

constexpr Time kStep{1'000'000};
constexpr double kSample_s = 1e-3;
/// Load cells have a port of their own, because they may be silent.
constexpr std::array kFromBridge{Role::maneuver, Role::rig_heartbeat, Role::emergency_stop, Role::maneuver_state};
constexpr std::array kLoadCells{Role::load_cells};

std::filesystem::path made(const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    return folder / "bus.log";
}

ImportSample between(const ImportSample& a, const ImportSample& b, double time_s) {
    const double x = (time_s - a.time_s) / (b.time_s - a.time_s);
    ImportSample s;
    s.time_s = time_s;
    s.load_cells = b.load_cells;
    for (std::size_t i = 0; i < kChannelCount; ++i) s.value[i] = a.value[i] + x * (b.value[i] - a.value[i]);
    return s;
}

}  // namespace

ManeuverWriter::ManeuverWriter(const ImportedRig& rig, const std::filesystem::path& folder)
    : rig_(rig),
      log_(made(folder), "import"),
      meter_(rig.layout, rig.meter),
      sensors_(rig.layout, kStep, antiskid::can::kFromRigSensors),
      bridge_(rig.layout, kStep, kFromBridge),
      load_cells_(rig.layout, kStep, kLoadCells),
      controller_(rig.layout, kStep),
      wheel_(rig.meter.wheel_teeth),
      flywheel_(rig.meter.flywheel_teeth) {}

void ManeuverWriter::add(const ImportSample& sample, rig::Phase phase) {
    if (!last_) {
        last_ = sample;
        next_ms_ = static_cast<std::int64_t>(std::ceil(sample.time_s / kSample_s));
    }
    for (; static_cast<double>(next_ms_) * kSample_s <= sample.time_s; ++next_ms_) {
        const double time_s = static_cast<double>(next_ms_) * kSample_s;
        step(sample.time_s > last_->time_s ? between(*last_, sample, time_s) : sample, phase);
    }
    last_ = sample;
}

void ManeuverWriter::step(const ImportSample& s, rig::Phase phase) {
    wheel_.advance(s[Channel::wheel_speed], s.time_s, kSample_s);
    flywheel_.advance(s[Channel::flywheel_speed] / rig_.meter.flywheel_radius_m, s.time_s, kSample_s);
    const bool braking = phase == rig::Phase::braking || phase == rig::Phase::standstill;
    antiskid::can::RigSample out;
    out.wheel = wheel_.sample();
    out.flywheel = flywheel_.sample();
    out.pressure_Pa = static_cast<float>(s[Channel::pressure]);
    out.maneuver = {.law = static_cast<antiskid::control::Law>(rig_.plan.law),
                    .arm = true,
                    .weight_on_wheels = true,
                    .demand_Pa = braking ? static_cast<float>(rig_.plan.demand_Pa) : 0.0F,
                    .slip_reference = static_cast<float>(rig_.plan.slip_reference),
                    .deceleration_mps2 = static_cast<float>(rig_.plan.deceleration_mps2),
                    .current_mA = static_cast<float>(s[Channel::valve_current])};
    out.load_cells = {.vertical_N = static_cast<float>(s[Channel::vertical_load]),
                      .longitudinal_N = static_cast<float>(s[Channel::longitudinal_force]),
                      .brake_torque_Nm = static_cast<float>(s[Channel::brake_torque])};
    out.maneuver_state = {.phase = static_cast<std::uint8_t>(phase),
                          .number = static_cast<std::uint32_t>(rig_.number),
                          .brake_temperature_C = static_cast<float>(s[Channel::brake_temperature])};
    const Time stamp{next_ms_ * kStep.count()};
    // A record without a single frame of them is one of a rig that has none.
    if (s.load_cells || !load_cells_sent_) load_cells_sent_ = send_due(load_cells_, out, stamp) > 0 || load_cells_sent_;
    for (RigPort* port : {&bridge_, &sensors_}) (void)send_due(*port, out, stamp);
    if (rig_.with_valve) send(controller_.valve_command(out.maneuver.current_mA), stamp);
}

std::size_t ManeuverWriter::send_due(RigPort& port, const antiskid::can::RigSample& sample, Time stamp) {
    std::array<Frame, RigPort::kMaxFrames> due{};
    const std::size_t count = port.due_frames(sample, due);
    for (std::size_t i = 0; i < count; ++i) send(due[i], stamp);
    return count;
}

void ManeuverWriter::send(Frame frame, Time stamp) {
    frame.received = stamp;
    meter_.accept(frame);
    record::CapturedFrame captured;
    captured.frame = frame;
    log_.write(captured);
}

void ManeuverWriter::finish() {
    if (!log_.finish()) throw std::runtime_error(log_.error());
}

}  // namespace rig::replay
