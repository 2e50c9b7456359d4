#include "rig_bridge/bridge/next_step.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>

#include "firmware/can/value_names.hpp"
#include "tests/catch.hpp"

using antiskid::control::Fault;
using antiskid::control::FaultSet;
using sequencer::Abort;
using sequencer::Phase;

namespace {

/// Lines of docs/user/next_steps.md that are rows of a table.
std::set<std::string> rows_of_page() {
    std::ifstream file("docs/user/next_steps.md");
    std::set<std::string> rows;
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("| `")) rows.insert(line);
    }
    return rows;
}

std::string row(std::string_view name, std::string_view happened, std::string_view next) {
    return fmt::format("| `{}` | {} | {} |", name, happened, next);
}

}  // namespace

TEST_CASE("docs/user/next_steps.md says of every abort cause, phase and fault what the bridge says", "[BRG-130]") {
    std::set<std::string> rows;
    for (std::uint8_t i = 1; i < sequencer::kAbortCount; ++i) {
        const rig::NextStep step = rig::next_step(static_cast<Abort>(i));
        rows.insert(row(name(static_cast<Abort>(i)), step.happened, step.next));
    }
    for (std::uint8_t i = 0; i < antiskid::control::kFaultCount; ++i) {
        const rig::NextStep step = rig::next_step(static_cast<Fault>(i));
        rows.insert(row(antiskid::can::kFaultNames[i], step.happened, step.next));
    }
    for (std::uint8_t i = 0; i <= static_cast<std::uint8_t>(Phase::cool_down); ++i)
        rows.insert(fmt::format("| `{}` | {} |", name(static_cast<Phase>(i)), rig::awaited(static_cast<Phase>(i))));
    const std::set<std::string> page = rows_of_page();
    std::vector<std::string> missing, surplus;
    std::set_difference(rows.begin(), rows.end(), page.begin(), page.end(), std::back_inserter(missing));
    std::set_difference(page.begin(), page.end(), rows.begin(), rows.end(), std::back_inserter(surplus));
    CHECK(missing.empty());
    CHECK(surplus.empty());
}

TEST_CASE("At an abort the bridge says what it means and what to do", "[BRG-130]") {
    const std::string foreign = rig::advice(Abort::foreign_command, Phase::spin_up, {});
    CHECK(foreign ==
          fmt::format("ABORT foreign_command in spin_up: somebody else commanded the PLC. Next: {}", rig::next_step(Abort::foreign_command).next));
    CHECK_THAT(rig::advice(Abort::phase_timeout, Phase::settling, {}), ContainsSubstring(", waiting for wheel and rim alike"));
    FaultSet faults;
    faults.insert(Fault::wheel_lost);
    faults.insert(Fault::bus_off);
    const std::string controller = rig::advice(Abort::controller_fault, Phase::braking, faults);
    CHECK(std::count(controller.begin(), controller.end(), '\n') == 2);
    CHECK_THAT(controller, ContainsSubstring("\n  wheel_lost: the wheel's encoder is not heard") && ContainsSubstring("\n  bus_off: "));
    // Faults that stand beside another cause are consequences.
    CHECK_THAT(rig::advice(Abort::emergency_stop, Phase::braking, faults), !ContainsSubstring("wheel_lost"));
}
