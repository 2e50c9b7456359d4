#include "plant_sim/simulation/cell_judge.hpp"

#include <fmt/format.h>

#include <utility>

#include "firmware/host/seconds.hpp"
#include "plant_sim/simulation/fault_timeline.hpp"
#include "plant_sim/simulation/faulty_bus.hpp"
#include "plant_sim/virtual_rig/serve_node.hpp"
#include "rig_bridge/bridge/next_step.hpp"
#include "rig_bridge/bridge/node.hpp"

namespace plant_sim::simulation {

using antiskid::can::Frame;
using antiskid::can::Role;
using antiskid::control::Time;
using antiskid::host::seconds;
using rig::Phase;

CellJudge::CellJudge(const CellSetup& setup, const rig::Plan& plan, const plc::ServedRig& rig, Sink violated)
    : setup_(setup),
      plan_(plan),
      rig_(rig),
      violated_(std::move(violated)),
      permission_(setup.bridge.layout),
      valve_(setup.bridge.layout),
      top_mps_(rig::top_speed_mps(plan)) {}

void CellJudge::rig_received(const Frame& frame) {
    if (frame.id != setup_.bridge.layout[Role::valve].id || valve_.accept(frame) != Role::valve) return;
    // The command may be delayed by as much as frames are late.
    const Time longest = duration(setup_.permission_s + 3.0 * static_cast<double>(setup_.controller.period_s)) + FaultyBus::kMaxLate;
    if (valve_.view().controller.current_mA > setup_.controller.valve.safe_current_mA + 0.01F && frame.received - permission_.granted() > longest)
        violated_(fmt::format("{:.2f} mA, {:.3f} s after the last permission", valve_.view().controller.current_mA,
                              seconds(frame.received - permission_.granted())));
}

void CellJudge::check(const CellNow& cell) {
    const Time now = cell.now;
    if (cell.open != open_) opened_ = now;
    open_ = cell.open;
    // What was written while its registers stood still, a PLC sees afterwards.
    written_ = written_ || (cell.loop_lives && cell.plc_reachable);
    if (!cell.plc_frozen && std::exchange(written_, false)) bridge_seen_ = now;
    // A loop that was stopped notices it at its next step.
    if ((cell.plc_reachable && !cell.plc_frozen) || !cell.loop_lives) plc_answered_ = now;
    if (cell.controller_lives || !cell.loop_lives) controller_lived_ = now;
    if (cell.sequencer != nullptr && cell.sequencer->phase() >= Phase::spin_up && cell.sequencer->phase() <= Phase::standstill) {
        const Time step = 2 * rig::bridge::Node::kStep + setup_.bridge.map.link.poll;
        // A controller's last frame may come late.
        if (now - plc_answered_ > duration(setup_.limits.registers_s) + step) violated_("the bridge goes on without a PLC");
        if (now - controller_lived_ > duration(setup_.limits.controller_s) + step + FaultyBus::kMaxLate)
            violated_("the bridge goes on without a controller");
    }
    machines(cell);
    if (rig_.rig().wheel().v_mps > top_mps_ + 0.1) violated_(fmt::format("the flywheel runs at {:.2f} m/s", rig_.rig().wheel().v_mps));
    // Valve and line release within half a second.
    const Time longest = duration(setup_.permission_s + 0.5) + FaultyBus::kMaxLate + ServeNode::kDriverWatchdog;
    if (rig_.rig().pressure_Pa() > 2.0 * plan_.pressure_gone_Pa && now - permission_.granted() > longest)
        violated_(
            fmt::format("{:.1f} MPa, {:.3f} s after the last permission", rig_.rig().pressure_Pa() * 1e-6, seconds(now - permission_.granted())));
}

void CellJudge::machines(const CellNow& cell) {
    const plc::MachineCommands& machines = rig_.plc().commands();
    if (!machines.drive && !machines.advance && !machines.load) return;
    if (open_ != 0 && cell.now - opened_ > duration(2.0 * plc::ServedRig::kScan_s)) violated_("drive, sledge or load is on with an interlock open");
    // A client whose main loop hangs keeps its watchdog counting for the user timeout; then come the PLC's timeout and one round of both.
    const rig::RegisterMap& map = setup_.bridge.map;
    const Time until_trip = map.bridge_timeout + map.link.user_timeout + map.link.poll + duration(2.0 * plc::ServedRig::kScan_s);
    if (cell.now - bridge_seen_ > until_trip) violated_("drive, sledge or load is on without a bridge");
}

void CellJudge::over(const rig::Sequencer& sequencer) {
    if (sequencer.phase() == Phase::finished) {
        if (rig_.maneuvers() != touchdowns_ + 1)
            violated_(fmt::format("a maneuver is finished, and the wheel touched down {} times", rig_.maneuvers() - touchdowns_));
        if (rig_.rig().wheel().v_mps > 1.0) violated_("a maneuver is finished, and the flywheel was not stopped");
        return;
    }
    if (sequencer.abort() == rig::Abort::none || rig::bridge::next_step(sequencer.abort()).happened.empty())
        violated_("an abort without a cause in words");
    if (sequencer.safe_end_seen() && (rig_.sledge_m() > 0.05 || rig_.rig().pressure_Pa() > 2.0 * plan_.pressure_gone_Pa))
        violated_(fmt::format("a safe end was seen, with the sledge at {:.2f} m and {:.1f} MPa", rig_.sledge_m(), rig_.rig().pressure_Pa() * 1e-6));
}

}  // namespace plant_sim::simulation
