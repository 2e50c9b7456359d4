/// The command line of antiskid-controller.
#pragma once

#include <spdlog/common.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "config/reader/config_directory.hpp"
#include "firmware/linux/realtime.hpp"

namespace antiskid::rt {

enum class ClockSource : std::uint8_t { timer, sync };

struct Options {
    std::string interface;
    ClockSource clock = ClockSource::timer;
    std::filesystem::path config = settings::config_directory() / "controller.toml";
    std::filesystem::path dbc = settings::config_directory() / "antiskid.dbc";
    std::filesystem::path binding = settings::config_directory() / "antiskid_binding.toml";
    std::optional<std::filesystem::path> report;
    RealtimeRequest realtime;
    int sync_timeout_ms = 1000;
    spdlog::level::level_enum log_level = spdlog::level::info;
};

/// The options, or the exit status when there is nothing to run: 0 after --help or --version, 2 after a
/// mistake, which has then been explained on standard error.
[[nodiscard]] std::variant<Options, int> parse_options(int argc, const char* const* argv);

}  // namespace antiskid::rt
