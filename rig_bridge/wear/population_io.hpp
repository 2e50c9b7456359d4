/// A population as JSON: readable, versioned, exact.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "rig_bridge/wear/population.hpp"

namespace wear {

constexpr const char* kPopulationFormat = "antiskid wear population";
constexpr int kPopulationFormatVersion = 3;

/// population_from_json(to_json(p)) == p, to the last bit.
[[nodiscard]] std::string to_json(const Population& population);

/// Also accepts a single model's JSON (model_io.hpp) and returns population_of() that model. Throws settings::Error with `name` and the key for a key
/// that is missing, unknown, of the wrong type or out of range, and for another format or version.
[[nodiscard]] Population population_from_json(const std::string& name, std::string_view json);

/// A population with the hash of its file's bytes.
struct PopulationFile {
    Population population;
    std::string hash;
};
[[nodiscard]] PopulationFile read_population(const std::filesystem::path& json);

}  // namespace wear
