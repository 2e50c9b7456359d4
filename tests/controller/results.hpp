/// Checks by name, and which of them did not pass.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "firmware/controller/check.hpp"
#include "tests/catch.hpp"

namespace controller_test {

namespace controller = antiskid::controller;

inline controller::Check named(const controller::Checks& checks, const std::string& name) {
    const auto found = std::find_if(checks.begin(), checks.end(), [&](const auto& check) { return check.name == name; });
    REQUIRE(found != checks.end());
    return *found;
}

/// "name: verdict" of all that neither passed nor was skipped.
inline std::vector<std::string> wrong(const controller::Checks& checks) {
    std::vector<std::string> found;
    for (const controller::Check& check : checks) {
        if (check.verdict == controller::CheckResult::pass || check.verdict == controller::CheckResult::skipped) continue;
        CHECK_FALSE(check.remedy.empty());
        found.push_back(check.name + ": " + std::string(controller::name(check.verdict)));
    }
    return found;
}

using Wrong = std::vector<std::string>;

}  // namespace controller_test
