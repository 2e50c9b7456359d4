/// Maps the columns, or CAN frames, of another system's recording to our signals; config/import_example.toml explains every key.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/can/layout.hpp"
#include "firmware/can/units.hpp"

namespace rig::replay {

enum class Channel : std::uint8_t {
    wheel_speed,     ///< rad/s
    flywheel_speed,  ///< m/s at the rim
    pressure,        ///< Pa
    vertical_load,   ///< N
    longitudinal_force,
    brake_torque,       ///< N m
    valve_current,      ///< mA
    brake_temperature,  ///< degrees Celsius
};
inline constexpr std::size_t kChannelCount = 8;
[[nodiscard]] std::string_view name(Channel channel);

struct ImportColumn {
    std::string column;
    std::string unit_name;
    antiskid::can::Unit unit;
};

struct ImportMap {
    bool mat = false;
    /// Of a log of frames, and the files that it came from; `channels` are then those that it has, in SI.
    std::optional<antiskid::can::Layout> layout;
    std::vector<std::filesystem::path> layout_files;
    std::optional<std::string> interface;  ///< only lines of this interface
    char separator = ',';
    char decimal = '.';
    std::uint64_t header_row = 1;
    std::uint64_t unit_row = 0;  ///< 0: none
    std::uint64_t first_data_row = 2;
    ImportColumn time;
    std::array<std::optional<ImportColumn>, kChannelCount> channels;
    std::string scenario;

    double brake_on_Pa = 0.0, released_Pa = 0.0;
    double min_speed_mps = 0.0, standstill_mps = 0.0;
    double before_s = 0.0, after_s = 0.0, longest_gap_s = 0.0;
};

/// Throws settings::Error naming file, line and key.
[[nodiscard]] ImportMap load_import_map(const std::filesystem::path& file);

}  // namespace rig::replay
