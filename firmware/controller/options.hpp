/// The command line of antiskid-controller.
#pragma once

#include <spdlog/common.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "firmware/host/layout_files.hpp"
#include "firmware/host/realtime.hpp"
#include "firmware/host/settings/config_directory.hpp"

namespace antiskid::controller {

enum class ClockSource : std::uint8_t { sensors, timer, sync };
/// The name used on the command line.
[[nodiscard]] std::string_view name(ClockSource clock);

/// `--check`: check everything before the wheel turns, without running the controller.
struct CheckRequest {
    int timing_s = 10;                  ///< duration of listening and timing
    bool valve_step = false;            ///< also make a small valve step
    std::uint32_t bitrate = 1'000'000;  ///< bit/s, of the rig's CAN
    std::string expect_hash;            ///< required hash of the configuration; empty: any
};

struct Options {
    std::string interface;
    ClockSource clock = ClockSource::sensors;
    std::filesystem::path controller = settings::config_directory() / "controller.toml";
    LayoutFiles layout{settings::config_directory()};
    std::string json;  ///< destination of the statistics or of --check's results: file, "-" for standard output, or empty
    host::RealtimeRequest realtime;
    int sync_timeout_ms = 1000;
    spdlog::level::level_enum log_level = spdlog::level::info;
    std::optional<CheckRequest> check;
};

/// The options, or the exit status if there is nothing to run: 0 after --help or --version, 2 after a usage error, which is reported on standard
/// error.
[[nodiscard]] std::variant<Options, int> parse_options(int argc, const char* const* argv);

}  // namespace antiskid::controller
