/// What one brake remembers between two runs of a program, as a file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "rig_bridge/wear/wearing_brake.hpp"

namespace wear {

constexpr const char* kBrakeStateFormat = "antiskid brake state";
constexpr int kBrakeStateFormatVersion = 1;

/// Of model and scale: a state is for the brake that it was kept of.
[[nodiscard]] std::string wear_hash(const BrakeWear& wear);

/// Readable JSON, exact to the last bit, with a check sum over its values.
[[nodiscard]] std::string to_json(const BrakeState& state, const BrakeWear& wear);

/// Throws settings::Error with `name` and the key of what is missing, unknown, of the wrong type or out of range, for another format or
/// version, for a check sum that does not fit, and for a state of another model or scale than `wear`.
[[nodiscard]] BrakeState brake_state_from_json(const std::string& name, std::string_view json, const BrakeWear& wear);

/// From a file; nothing where there is none. Throws as above.
[[nodiscard]] std::optional<BrakeState> find_brake_state(const std::filesystem::path& file, const BrakeWear& wear);

/// To a file that is whole or as it was. Throws settings::Error.
void keep_brake_state(const std::filesystem::path& file, const BrakeState& state, const BrakeWear& wear);

}  // namespace wear
