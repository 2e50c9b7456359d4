#include "plant_sim/simulation/cell_faults.hpp"

#include <fmt/format.h>

#include <cmath>

namespace plant_sim::simulation {

namespace {

bool has_node(CellFault fault) {
    return fault <= CellFault::off_bus;
}

bool has_share(CellFault fault) {
    return fault < CellFault::off_bus || (fault >= CellFault::requests_lost && fault <= CellFault::requests_doubled);
}

}  // namespace

std::string text(const PlannedFault& fault) {
    std::string what(kCellFaultNames.at(static_cast<std::size_t>(fault.fault)));
    if (has_node(fault.fault)) what += fmt::format(", {}", kBusNodeNames.at(static_cast<std::size_t>(fault.node)));
    if (fault.fault == CellFault::interlock_open) what += fmt::format(", {}", rig::name(fault.interlock));
    if (has_share(fault.fault)) what += fmt::format(", {:.0f} %", 100.0 * fault.share);
    if (fault.fault == CellFault::clock_set) what += fmt::format(", by {} s", fault.set_s);
    if (of_disk(fault.fault)) what += fmt::format(", at operation {}", fault.operation);
    if (fault.fault == CellFault::disk_full) what += fmt::format(", for {}", fault.operations);
    return fmt::format("{}, {:.3f} s into {} of attempt {}, for {:.3f} s", what, fault.after_s, rig::name(fault.phase), fault.attempt, fault.lasts_s);
}

std::vector<PlannedFault> draw_faults(wear::Generator& draw) {
    constexpr std::uint64_t kMaxFaults = 5;
    constexpr std::uint64_t kMaxAttempt = 3;
    constexpr std::array kPhases{rig::Phase::idle,    rig::Phase::spin_up,    rig::Phase::touchdown, rig::Phase::settling,
                                 rig::Phase::braking, rig::Phase::standstill, rig::Phase::retract,   rig::Phase::aborting};
    constexpr std::array kShares{0.05, 0.3, 1.0};
    constexpr std::array kSet_s{-86'400.0, -3600.0, -5.0, -0.5, 0.5, 5.0, 3600.0, 86'400.0};
    constexpr std::uint64_t kMaxOperation = 60;  // beginning or entering a maneuver takes about as many
    constexpr std::uint64_t kMaxFull = 30;
    constexpr double kMaxAfter_s = 2.0;
    constexpr double kShortest_s = 0.01;
    constexpr double kLongest_s = 8.0;
    const auto below = [&draw](std::uint64_t bound) { return draw() % bound; };
    std::vector<PlannedFault> faults(1 + below(kMaxFaults));
    for (PlannedFault& fault : faults) {
        fault.fault = static_cast<CellFault>(below(kCellFaultNames.size()));
        fault.node = static_cast<BusNode>(below(kBusNodeNames.size()));
        fault.interlock = static_cast<rig::Interlock>(below(rig::kInterlockCount));
        fault.share = kShares.at(below(kShares.size()));
        fault.attempt = static_cast<int>(1 + below(kMaxAttempt));
        fault.phase = kPhases.at(below(kPhases.size()));
        fault.after_s = kMaxAfter_s * wear::uniform(draw);
        fault.lasts_s = kShortest_s * std::pow(kLongest_s / kShortest_s, wear::uniform(draw));
        fault.set_s = kSet_s.at(below(kSet_s.size()));
        fault.operation = 1 + below(kMaxOperation);
        fault.operations = 1 + below(kMaxFull);
    }
    return faults;
}

}  // namespace plant_sim::simulation
