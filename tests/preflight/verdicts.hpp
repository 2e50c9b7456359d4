/// Checks by name, and which of them did not pass.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "firmware/preflight/check.hpp"
#include "tests/catch.hpp"

namespace preflight_test {

namespace preflight = antiskid::preflight;

inline preflight::Check named(const preflight::Checks& checks, const std::string& name) {
    const auto found = std::find_if(checks.begin(), checks.end(), [&](const auto& check) { return check.name == name; });
    REQUIRE(found != checks.end());
    return *found;
}

/// "name: verdict" of all that neither passed nor was skipped.
inline std::vector<std::string> wrong(const preflight::Checks& checks) {
    std::vector<std::string> found;
    for (const preflight::Check& check : checks) {
        if (check.verdict == preflight::Verdict::pass || check.verdict == preflight::Verdict::skipped) continue;
        CHECK_FALSE(check.remedy.empty());
        found.push_back(check.name + ": " + std::string(preflight::name(check.verdict)));
    }
    return found;
}

using Wrong = std::vector<std::string>;

}  // namespace preflight_test
