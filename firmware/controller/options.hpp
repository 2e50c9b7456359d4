/// The command line of antiskid-controller.
#pragma once

#include <spdlog/common.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "firmware/host/realtime.hpp"
#include "firmware/host/settings/config_directory.hpp"

namespace antiskid::controller {

enum class ClockSource : std::uint8_t { sensors, timer, sync };
/// As on the command line.
[[nodiscard]] std::string_view name(ClockSource clock);

/// `--check`: look at everything before the wheel turns, and run nothing.
struct CheckRequest {
    int timing_s = 10;                  ///< of listening and timing
    bool valve_step = false;            ///< also move the valve a little
    std::uint32_t bitrate = 1'000'000;  ///< of the rig's CAN
    std::string expect_hash;            ///< of the configuration; empty: any
};

struct Options {
    std::string interface;
    ClockSource clock = ClockSource::sensors;
    std::filesystem::path controller = settings::config_directory() / "controller.toml";
    std::filesystem::path dbc = settings::config_directory() / "antiskid.dbc";
    std::filesystem::path binding = settings::config_directory() / "antiskid_binding.toml";
    std::string json;  ///< of the statistics, or what --check found: file, "-" for standard output, or empty
    host::RealtimeRequest realtime;
    int sync_timeout_ms = 1000;
    spdlog::level::level_enum log_level = spdlog::level::info;
    std::optional<CheckRequest> check;
};

/// The options, or the exit status when there is nothing to run: 0 after --help or --version, 2 after a
/// mistake, which has then been explained on standard error.
[[nodiscard]] std::variant<Options, int> parse_options(int argc, const char* const* argv);

}  // namespace antiskid::controller
