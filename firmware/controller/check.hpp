/// Results of the checks made before the wheel turns by `antiskid-controller --check` and `rig-bridge preflight`: as a table, as JSON, and as exit
/// status.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace antiskid::controller {

enum class CheckResult : std::uint8_t {
    pass,
    warn,     ///< the rig may run, but the operator should know
    fail,     ///< the rig must not run
    skipped,  ///< not checked, `measured` says why; never counted as passed
};
[[nodiscard]] std::string_view name(CheckResult verdict);

struct Check {
    std::string name;
    CheckResult verdict = CheckResult::skipped;
    std::string measured;
    std::string required;
    std::string remedy;                                   ///< command or action that corrects it; empty if none is needed
    std::vector<std::pair<std::string, double>> figures;  ///< for JSON: name with unit, and value
};
using Checks = std::vector<Check>;

/// Texts of a check, see Check.
struct CheckTexts {
    std::string measured;
    std::string required;
    std::string remedy;
};
/// Verdict `pass` if `good`, else `otherwise`. A passed check has no remedy.
[[nodiscard]] Check judged(std::string name, bool good, CheckTexts texts, CheckResult otherwise = CheckResult::fail);
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
/// One line per check with its remedy below, then the number of each verdict. Ends in a newline.
[[nodiscard]] std::string table(const Report& report);
/// One object, ends in a newline.
[[nodiscard]] std::string json(const Report& report);

/// The table on standard output, JSON to the file `json_place`; "-": JSON on standard output instead of the table, "": no JSON.
/// Returns the exit status: 0 passed, 1 a check failed. Throws settings::Error when the file cannot be written.
[[nodiscard]] int deliver(const Report& report, const std::string& json_place);

}  // namespace antiskid::controller
