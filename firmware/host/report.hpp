/// What a run leaves behind: a table for the reader at the terminal, JSON for programs.
#pragma once

#include <cstdint>
#include <string>

#include "firmware/can/bus.hpp"
#include "firmware/can/controller_port.hpp"
#include "firmware/can/layout.hpp"
#include "firmware/host/loop_statistics.hpp"

namespace antiskid::rt {

struct RunReport {
    std::string interface;
    std::string clock;        ///< "timer" or "sync"
    std::string config_hash;  ///< of the configuration, DBC and binding in force
    control::Time period{};
    std::uint64_t records_lost = 0;  ///< of the log's, not of the bus's
    can::LinkStatus link;
    const can::Layout& layout;
    const can::ControllerPort& port;
    const LoopStatistics& loop;
};

/// Several lines, each ending in a newline.
[[nodiscard]] std::string table(const RunReport& report);

/// One object; docs/engineering/controller.md has its keys. Durations in ns.
[[nodiscard]] std::string json(const RunReport& report);

}  // namespace antiskid::rt
