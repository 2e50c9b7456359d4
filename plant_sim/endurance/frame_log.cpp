#include "plant_sim/endurance/frame_log.hpp"

#include <array>
#include <stdexcept>

#include "firmware/can/roles.hpp"

namespace endurance {

using antiskid::can::Frame;
using antiskid::can::Role;

namespace {

/// Messages sent by a rig and its bridge.
constexpr std::array kSaid{Role::wheel,         Role::flywheel,       Role::pressure,   Role::maneuver,
                           Role::rig_heartbeat, Role::emergency_stop, Role::load_cells, Role::maneuver_state};

}  // namespace

FrameLog::FrameLog(const antiskid::can::Layout& layout, antiskid::control::Time period, const std::filesystem::path& file)
    : rig_(layout, period, kSaid), controller_(layout, period), log_(file, "vcan0"), period_(period) {}

void FrameLog::write(Frame frame) {
    frame.received = now_;
    rig::record::CapturedFrame captured;
    captured.frame = frame;
    log_.write(captured);
}

void FrameLog::add(const Period& period) {
    std::array<Frame, antiskid::can::RigPort::kMaxFrames> said{};
    const std::size_t count = rig_.due_frames(period.sample, said);
    for (std::size_t i = 0; i < count; ++i) write(said[i]);
    write(rig_.sync(number_++));
    std::array<Frame, antiskid::can::ControllerPort::kMaxFrames> answered{};
    const std::size_t answers = controller_.due_frames(period.command, answered);
    for (std::size_t i = 0; i < answers; ++i) write(answered[i]);
    now_ += period_;
}

void FrameLog::finish() {
    if (!log_.finish()) throw std::runtime_error(log_.error());
}

}  // namespace endurance
