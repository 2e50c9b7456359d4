/// File with a brake's state between two runs of a program.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "rig_bridge/wear/wearing_brake.hpp"

namespace wear {

constexpr const char* kBrakeStateFormat = "antiskid brake state";
constexpr int kBrakeStateFormatVersion = 1;

/// Hash of model and scale: a state is only valid for the brake with the same hash.
[[nodiscard]] std::string wear_hash(const BrakeWear& wear);

/// Readable JSON with all bits of the numbers and a checksum.
[[nodiscard]] std::string to_json(const BrakeState& state, const BrakeWear& wear);

/// Throws settings::Error with `name` and the key for a missing, unknown, wrongly typed or out-of-range value, another format or version, a wrong
/// checksum, and a state of another model or scale than `wear`.
[[nodiscard]] BrakeState brake_state_from_json(const std::string& name, std::string_view json, const BrakeWear& wear);

/// Reads the state from a file; none: there is no file. Throws as above.
[[nodiscard]] std::optional<BrakeState> find_brake_state(const std::filesystem::path& file, const BrakeWear& wear);

/// Writes the state to a file, which after a failure is unchanged. Throws settings::Error.
void write_brake_state(const std::filesystem::path& file, const BrakeState& state, const BrakeWear& wear);

}  // namespace wear
