/// Converts between the sequencer's inputs and outputs and those of PLC and bus. Pure.
#pragma once

#include "firmware/can/rig_sample.hpp"
#include "rig_bridge/bridge/plc_and_bus.hpp"
#include "rig_bridge/record/work_balance.hpp"
#include "rig_bridge/rig/sequencer.hpp"

namespace rig::bridge {

/// Largest ages of valid values, s of the machine's clock: from config/bridge.toml and plc_timeout of the register map.
struct Freshness {
    double registers_s = 0.5;
    double sensors_s = 0.3;
    double controller_s = 0.3;
    double commit_s = 1.0;                      ///< until the PLC must have confirmed a command
    double load_cells_s = record::kRepeated_s;  ///< older readings, and those of a PLC whose plc_watchdog stands still for so long, stay off the bus
    double watchdog_s = 0.3;
    double load_cells_late_s = 0.0;  ///< no limit: age that their readings have in the PLC's registers
    double recorder_s = 0.5;         ///< since the recorder read the bus; after that no value from the bus is valid
};

/// Whether every interlock is read, fresh and good.
[[nodiscard]] bool interlocks_good(const modbus::Snapshot& plc, const Freshness& limits);
/// Whether all registers are fresh and the PLC's watchdog counts.
[[nodiscard]] bool plc_fresh(const modbus::Snapshot& plc, const Freshness& limits);

/// `now`: steady clock.
[[nodiscard]] rig::Inputs sequencer_inputs(const modbus::Snapshot& plc, const BusNow& bus, antiskid::can::Time now, const Freshness& limits);

[[nodiscard]] CommandedValues commands(const rig::Outputs& out, bool reset);

/// The bridge's values for the bus, without load cells, see load_cells().
[[nodiscard]] antiskid::can::RigSample rig_sample(const rig::Outputs& out, const MeasuredValues& plc, std::int64_t maneuver_number);
[[nodiscard]] antiskid::can::LoadCellSample load_cells(const MeasuredValues& plc);
/// Whether all three were read, and plc_watchdog has changed, within `load_cells_s`: a PLC whose program has stopped still answers, with old
/// readings. plc_watchdog may count only every 100 ms, so with a limit of 100 ms single frames may be missing.
[[nodiscard]] bool load_cells_fresh(const modbus::Snapshot& plc, const Freshness& limits);

}  // namespace rig::bridge
