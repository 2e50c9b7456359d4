/// The signals of a log as a table: one row per sample, one column per quantity, with the unit in its name.
#pragma once

#include <string>
#include <vector>

#include "rig_bridge/record/meter.hpp"
#include "rig_bridge/replay/measured_signals.hpp"
#include "rig_bridge/replay/shaft_speed.hpp"

namespace rig::replay {

class SampleTable {
  public:
    /// All must outlive the table.
    SampleTable(MeasuredSignals& signals, const antiskid::can::Layout& layout, const record::MeterParameters& rig);

    /// time_s from 0, then the columns whose message is in the layout. Phases, states and faults are the codes on the bus.
    [[nodiscard]] const std::vector<std::string>& columns() const { return columns_; }
    /// The next row, in the order of columns(); NaN before the first frame with the value. False at the end.
    [[nodiscard]] bool next(std::vector<double>& row);

  private:
    MeasuredSignals& signals_;
    const antiskid::can::Layout& layout_;
    double flywheel_radius_m_, wheel_radius_m_;
    ShaftSpeed wheel_, flywheel_;
    std::vector<std::string> columns_;
};

}  // namespace rig::replay
