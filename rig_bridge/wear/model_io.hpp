/// The fitted model as JSON: readable, versioned, exact.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "firmware/host/settings/json_object.hpp"
#include "rig_bridge/wear/model.hpp"

namespace wear {

constexpr const char* kModelFormat = "antiskid wear model";
constexpr int kModelFormatVersion = 2;

/// from_json(to_json(m)) == m, to the last bit, and to_json of it the same bytes.
[[nodiscard]] std::string to_json(const Model& model);

/// A file of version 1 states no origin: it is unknown. Throws settings::Error with `name` and the key for a key that is missing, unknown, of the
/// wrong type or out of range, and for another format or version.
[[nodiscard]] Model from_json(const std::string& name, std::string_view json);

[[nodiscard]] Model read_model(const std::filesystem::path& json);

[[nodiscard]] settings::Json json_of(const Provenance& provenance);
/// The key `origin` of a learnt file.
[[nodiscard]] std::string origin_in(settings::JsonObject& object);

}  // namespace wear
