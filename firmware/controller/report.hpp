/// Report of a run: a table for people, JSON for programs.
#pragma once

#include <cstdint>
#include <string>

#include "firmware/can/bus.hpp"
#include "firmware/can/controller_port.hpp"
#include "firmware/can/layout.hpp"
#include "firmware/host/loop_statistics.hpp"

namespace antiskid::controller {

struct RunReport {
    std::string interface;
    std::string clock;        ///< "timer" or "sync"
    std::string config_hash;  ///< of the configuration, DBC and binding in force
    control::Time period{};
    std::uint64_t records_lost = 0;  ///< CycleRecords that did not fit into the ring; the bus lost nothing by it
    can::LinkStatus link;
    const can::Layout& layout;
    const can::ControllerPort& port;
    const host::LoopStatistics& loop;
};

/// Several lines, each ending in a newline.
[[nodiscard]] std::string table(const RunReport& report);

/// One object; docs/engineering/controller.md has its keys. Durations in ns.
[[nodiscard]] std::string json(const RunReport& report);

}  // namespace antiskid::controller
