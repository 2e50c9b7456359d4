/// The wall clock as text.
#pragma once

#include <fmt/chrono.h>

#include <chrono>
#include <string>

namespace rig::bridge {

/// ISO 8601, UTC, whole seconds: "2026-11-21T11:02:03Z".
[[nodiscard]] inline std::string iso_8601(std::chrono::system_clock::time_point at) {
    return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(at)));
}

}  // namespace rig::bridge
