/// Between the sequencer's words and those of the PLC and the bus. Pure.
#pragma once

#include "firmware/can/rig_sample.hpp"
#include "rig_bridge/bridge/parts.hpp"
#include "rig_bridge/rig/sequencer.hpp"

namespace rig::bridge {

/// How old a value may be and still count, s of the machine's time: config/bridge.toml and plc_timeout of the register map.
struct Freshness {
    double registers_s = 0.5;
    double sensors_s = 0.3;
    double controller_s = 0.3;
    double commit_s = 1.0;  ///< until the PLC has confirmed a command
    double load_cells_s = 0.1;
    double watchdog_s = 0.3;
    double recorder_s = 0.5;  ///< the recorder's thread stands still: nothing on the bus counts
};

/// Every interlock is read, fresh and good.
[[nodiscard]] bool interlocks_good(const modbus::Snapshot& plc, const Freshness& limits);
/// All registers are fresh and the PLC's watchdog moves.
[[nodiscard]] bool plc_fresh(const modbus::Snapshot& plc, const Freshness& limits);

/// `now`: steady clock.
[[nodiscard]] rig::Inputs look(const modbus::Snapshot& plc, const BusNow& bus, antiskid::can::Time now, const Freshness& limits);

[[nodiscard]] CommandedValues commands(const rig::Outputs& out, bool reset);

/// What the bridge says on the bus; load cells apart, see load_cells().
[[nodiscard]] antiskid::can::RigSample telegram(const rig::Outputs& out, const MeasuredValues& plc, std::int64_t maneuver_number);
[[nodiscard]] antiskid::can::LoadCellSample load_cells(const MeasuredValues& plc);
/// All three read within `load_cells_s`, and plc_watchdog has moved within it: a PLC that stands still answers, too, with readings of before. The
/// slowest PLC that the register map allows counts each 100 ms, so with a limit of 100 ms the frames of one request may be missing.
[[nodiscard]] bool load_cells_fresh(const modbus::Snapshot& plc, const Freshness& limits);

}  // namespace rig::bridge
