/// Checks before the wheel turns, as `antiskid-controller --check` and `rig-bridge preflight` show them: a table for the reader at the
/// terminal, JSON for programs, one exit status. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace antiskid::controller {

enum class CheckResult : std::uint8_t {
    pass,
    warn,     ///< the rig may run; somebody should know
    fail,     ///< the rig does not run
    skipped,  ///< not looked at: `measured` says why. Never counted as passed
};
[[nodiscard]] std::string_view name(CheckResult verdict);

struct Check {
    std::string name;
    CheckResult verdict = CheckResult::skipped;
    std::string measured;
    std::string required;
    std::string remedy;                                   ///< the command, or the deed, that mends it; empty where nothing is to be mended
    std::vector<std::pair<std::string, double>> figures;  ///< for JSON: a name with its unit, a number
};
using Checks = std::vector<Check>;

/// What a verdict is made of besides whether it is good.
struct Words {
    std::string measured;
    std::string required;
    std::string remedy;
};
/// Passed when `good`, else `otherwise`; the remedy of a passed one is dropped.
[[nodiscard]] Check judged(std::string name, bool good, Words words, CheckResult otherwise = CheckResult::fail);
[[nodiscard]] Check skipped(std::string name, std::string why, std::string required);

void append(Checks& checks, Checks more);

struct Report {
    std::string program;
    std::string interface;    ///< CAN
    std::string config_hash;  ///< empty: the configuration could not be read
    Checks checks;
};

/// Whether no check failed.
[[nodiscard]] bool passed(const Report& report);
/// A line for each check, its remedy below it, and how many of each verdict. Ends in a newline.
[[nodiscard]] std::string table(const Report& report);
/// One object, ends in a newline.
[[nodiscard]] std::string json(const Report& report);

/// The table on standard output, JSON to the file `json_place`; "-": JSON on standard output instead of the table, "": no JSON.
/// Returns the exit status: 0 passed, 1 a check failed. Throws settings::Error when the file cannot be written.
[[nodiscard]] int deliver(const Report& report, const std::string& json_place);

}  // namespace antiskid::controller
