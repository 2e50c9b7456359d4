/// What was measured: a table for the reader, JSON for programs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plant_sim/bench/command.hpp"
#include "plant_sim/bench/wake_up.hpp"

namespace antiskid::bench {

struct Results {
    std::vector<WakeUpRound> wake_up;  ///< none: not measured
    std::optional<CommandLatency> command;
    std::vector<std::string> failures;  ///< why something was not measured
};

/// Several lines, each ending in a newline.
[[nodiscard]] std::string table(const Results& results);

/// One object. All durations in us; `wake_up.median` is each figure's median over the rounds, `command.all` of
/// all rounds together; `ratio` is the controller's figure over the other's.
[[nodiscard]] std::string json(const Settings& settings, const Results& results);

}  // namespace antiskid::bench
