#include "rig_bridge/bridge/node.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "firmware/can/roles.hpp"

namespace rig::bridge {

using antiskid::can::Frame;
using antiskid::can::Role;
using antiskid::can::Time;
using rig::Phase;

namespace {

/// Load cells go out only while they are fresh; RigPort's cycle would not ask.
constexpr std::array kCycle{Role::maneuver, Role::rig_heartbeat, Role::emergency_stop, Role::maneuver_state};

}  // namespace

Node::Node(const antiskid::can::Layout& layout, double period_s, const Freshness& limits, Plc& plc, const BusFeed& feed, antiskid::can::Bus& bus)
    : layout_(layout),
      limits_(limits),
      plc_(plc),
      feed_(feed),
      bus_(bus),
      port_(layout, kStep, kCycle),
      time_(period_s),
      load_cell_steps_(static_cast<std::uint64_t>(std::max<std::int64_t>(layout[Role::load_cells].period / kStep, 1))) {}

bool Node::nothing_on() const {
    const rig::Outputs& out = moment_.outputs;
    return !out.drive_enable && !out.sledge_advance && !out.load_enable && !out.arm;
}

const Moment& Node::step(rig::Sequencer* sequencer, const Wishes& wishes, Time now) {
    moment_.now = now;
    moment_.plc = plc_.snapshot();
    moment_.bus = feed_.now();
    moment_.inputs = sequencer_inputs(moment_.plc, moment_.bus, now, limits_);
    moment_.inputs.bus_up = moment_.inputs.bus_up && bus_.status().up;
    moment_.inputs.abort_requested = wishes.abort;
    moment_.inputs.foreign_command = moment_.plc.foreign_commands != foreign_commands_;
    foreign_commands_ = moment_.plc.foreign_commands;
    moment_.rig_s = time_.at(std::chrono::duration<double>(now).count(), moment_.bus.syncs);
    moment_.outputs = sequencer == nullptr ? rig::Outputs{} : sequencer->step(moment_.inputs, moment_.rig_s);

    const bool tripped = moment_.inputs.plc_fresh && !moment_.inputs.plc_ready;
    const bool idle = nothing_on() && (moment_.outputs.phase == Phase::idle || (sequencer != nullptr && sequencer->over()));
    moment_.resetting =
        reset_.step(wishes.reset && idle && tripped && interlocks_good(moment_.plc, limits_), std::chrono::duration<double>(now).count());
    plc_.command(commands(moment_.outputs, moment_.resetting));
    send(wishes.number);
    ++steps_;
    return moment_;
}

/// A phase and its command are sent together: otherwise a delay before the next step would leave the controller with the previous phase's command,
/// while figures are already counted from the new phase.
bool Node::command_waits(std::span<const Frame> due) const {
    return moment_.outputs.phase != sent_phase_ &&
           std::none_of(due.begin(), due.end(), [this](const Frame& frame) { return frame.id == layout_[Role::maneuver].id; });
}

void Node::send(std::int64_t number) {
    // Takes note of what became of the link; the frames themselves are the recorder's.
    std::array<Frame, antiskid::can::RigPort::kMaxFrames> frames{};
    (void)bus_.receive(frames);
    const antiskid::can::RigSample sample = rig_sample(moment_.outputs, moment_.plc.values, number);
    const auto due = std::span(frames).first(port_.due_frames(sample, frames));
    if (command_waits(due)) (void)bus_.send(port_.maneuver(sample.maneuver));
    sent_phase_ = moment_.outputs.phase;
    for (const Frame& frame : due) (void)bus_.send(frame);
    if (layout_[Role::load_cells].bound && steps_ % load_cell_steps_ == 0) send_load_cells();
}

/// Only new readings: those of a PLC that stands still would count as measured until it is noticed.
void Node::send_load_cells() {
    const antiskid::can::LoadCellSample reading = load_cells(moment_.plc.values);
    const double watchdog = at(moment_.plc.values, Measured::plc_watchdog);
    if (!load_cells_fresh(moment_.plc, limits_) || (reading == sent_reading_ && watchdog == sent_watchdog_)) return;
    sent_reading_ = reading;
    sent_watchdog_ = watchdog;
    antiskid::can::LoadCellSample sent = reading;
    const double asked_s = moment_.plc.age_s[static_cast<std::size_t>(Measured::brake_torque_Nm)];
    sent.age = Time{std::llround((asked_s + limits_.load_cells_late_s) * 1e9)};
    (void)bus_.send(port_.load_cells(sent));
}

}  // namespace rig::bridge
