/// Shared by the readers and writers of the wear model's files.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/near_miss.hpp"
#include "rig_bridge/wear/provenance.hpp"

namespace wear {

/// A JSON object and its place in the file; every key must be read.
class JsonObject {
  public:
    JsonObject(std::string file, std::string path, const settings::Json& json) : file_(std::move(file)), path_(std::move(path)), json_(json) {
        if (!json_.is_object()) throw settings::Error(file_, 0, path_, "must be an object");
    }

    [[nodiscard]] bool has(const std::string& key) const { return json_.contains(key); }
    [[nodiscard]] const settings::Json& get(const std::string& key) {
        const auto at = json_.find(key);
        if (at == json_.end()) throw settings::Error(file_, 0, path_of(key), "is missing");
        ++asked_;
        return *at;
    }
    [[nodiscard]] JsonObject object(const std::string& key) { return {file_, path_of(key), get(key)}; }
    [[nodiscard]] std::vector<JsonObject> objects(const std::string& key) {
        const settings::Json& list = get(key);
        if (!list.is_array() || list.empty()) throw settings::Error(file_, 0, path_of(key), "must be an array of objects, not empty");
        std::vector<JsonObject> out;
        out.reserve(list.size());
        for (std::size_t i = 0; i < list.size(); ++i) out.emplace_back(file_, fmt::format("{}[{}]", path_of(key), i), list[i]);
        return out;
    }
    [[nodiscard]] double number(const std::string& key) {
        const settings::Json& value = get(key);
        if (!value.is_number() || !std::isfinite(value.get<double>())) throw settings::Error(file_, 0, path_of(key), "must be a finite number");
        return value.get<double>();
    }
    [[nodiscard]] double positive(const std::string& key) {
        const double value = number(key);
        if (value <= 0.0) throw settings::Error(file_, 0, path_of(key), fmt::format("{} must be positive", value));
        return value;
    }
    [[nodiscard]] std::uint64_t count(const std::string& key, std::uint64_t min = 0) {
        const settings::Json& value = get(key);
        if (!value.is_number_unsigned() || value.get<std::uint64_t>() < min)
            throw settings::Error(file_, 0, path_of(key), fmt::format("must be an integer of at least {}", min));
        return value.get<std::uint64_t>();
    }
    [[nodiscard]] std::string text(const std::string& key) {
        const settings::Json& value = get(key);
        if (!value.is_string()) throw settings::Error(file_, 0, path_of(key), "must be a string");
        return value.get<std::string>();
    }
    /// The keys `format` and `format_version` must be these, or an earlier version that is still read. Returns the version.
    std::uint64_t check_format(std::string_view format, std::uint64_t version, std::uint64_t oldest) {
        if (text("format") != format) throw settings::Error(file_, 0, "format", fmt::format("must be '{}'", format));
        const auto is = count("format_version");
        if (is < oldest || is > version)
            throw settings::Error(file_, 0, "format_version", fmt::format("{} is not the version that this program reads ({})", is, version));
        return is;
    }
    void check_format(std::string_view format, std::uint64_t version) { (void)check_format(format, version, version); }
    /// Origin of a learnt file.
    [[nodiscard]] std::string origin() {
        const std::string text = this->text("origin");
        if (!is_origin(text)) throw settings::Error(file_, 0, path_of("origin"), "must begin with 'measured' or 'made up', or be 'unknown origin'");
        return settings::printable(text);
    }
    /// Call after reading every key; throws for unread ones.
    void finish() const {
        if (asked_ != json_.size()) throw settings::Error(file_, 0, path_, "has a key that this format does not know");
    }

  private:
    [[nodiscard]] std::string path_of(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }

    std::string file_;
    std::string path_;
    const settings::Json& json_;
    std::size_t asked_ = 0;
};

[[nodiscard]] inline settings::Json json_of(const Provenance& p) {
    return {{"origin", p.origin}, {"lives", p.lives}};
}

[[nodiscard]] inline settings::Json parsed_json(const std::string& file, std::string_view text) {
    try {
        return settings::parse_json(text);
    } catch (const settings::Json::exception& e) {  // a number too large for a double is no parse_error
        throw settings::Error(file, 0, "", fmt::format("no JSON: {}", settings::printable(e.what())));
    }
}

}  // namespace wear
