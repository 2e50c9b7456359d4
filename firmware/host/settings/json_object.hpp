/// Strict reader of a file of ours in JSON: what is missing, of another type or unknown is refused, with file and key.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/near_miss.hpp"

namespace settings {

/// A JSON object and its place in the file; every key must be read.
class JsonObject {
  public:
    JsonObject(std::string file, std::string path, const Json& json) : file_(std::move(file)), path_(std::move(path)), json_(json) {
        if (!json_.is_object()) throw Error(file_, 0, path_, "must be an object");
    }

    /// False also where it is null.
    [[nodiscard]] bool has(const std::string& key) {
        known_.insert(key);
        const auto at = json_.find(key);
        return at != json_.end() && !at->is_null();
    }
    [[nodiscard]] const Json& get(const std::string& key) {
        const auto at = json_.find(key);
        if (at == json_.end()) fail(key, "is missing");
        known_.insert(key);
        return *at;
    }
    [[nodiscard]] JsonObject object(const std::string& key) { return {file_, path_of(key), get(key)}; }
    [[nodiscard]] std::vector<JsonObject> objects(const std::string& key) {
        const Json& list = get(key);
        if (!list.is_array() || list.empty()) fail(key, "must be an array of objects, not empty");
        std::vector<JsonObject> out;
        out.reserve(list.size());
        for (std::size_t i = 0; i < list.size(); ++i) out.emplace_back(file_, fmt::format("{}[{}]", path_of(key), i), list[i]);
        return out;
    }
    [[nodiscard]] double number(const std::string& key) {
        const Json& value = get(key);
        if (!value.is_number() || !std::isfinite(value.get<double>())) fail(key, "must be a finite number");
        return value.get<double>();
    }
    /// NaN where it is null.
    [[nodiscard]] double number_or_nan(const std::string& key) { return get(key).is_null() ? std::numeric_limits<double>::quiet_NaN() : number(key); }
    [[nodiscard]] double positive(const std::string& key) {
        const double value = number(key);
        if (value <= 0.0) fail(key, fmt::format("{} must be positive", value));
        return value;
    }
    [[nodiscard]] std::uint64_t count(const std::string& key, std::uint64_t min = 0, std::uint64_t max = std::numeric_limits<std::uint64_t>::max()) {
        const Json& value = get(key);
        if (!value.is_number_unsigned() || value.get<std::uint64_t>() < min) fail(key, fmt::format("must be an integer of at least {}", min));
        if (value.get<std::uint64_t>() > max) fail(key, fmt::format("must be at most {}", max));
        return value.get<std::uint64_t>();
    }
    [[nodiscard]] std::string text(const std::string& key) {
        const Json& value = get(key);
        if (!value.is_string()) fail(key, "must be a string");
        return value.get<std::string>();
    }
    [[nodiscard]] std::vector<std::string> texts(const std::string& key) {
        const Json& list = get(key);
        if (!list.is_array() || !std::all_of(list.begin(), list.end(), [](const Json& one) { return one.is_string(); }))
            fail(key, "must be a list of strings");
        return list.get<std::vector<std::string>>();
    }
    [[nodiscard]] bool flag(const std::string& key) {
        const Json& value = get(key);
        if (!value.is_boolean()) fail(key, "must be true or false");
        return value.get<bool>();
    }
    /// The keys `format` and `format_version` must be these, or an earlier version that is still read. Returns the version.
    std::uint64_t check_format(std::string_view format, std::uint64_t version, std::uint64_t oldest) {
        if (text("format") != format) fail("format", fmt::format("must be '{}'", format));
        const auto is = count("format_version");
        if (is < oldest || is > version) fail("format_version", fmt::format("{} is not the version that this program reads ({})", is, version));
        return is;
    }
    void check_format(std::string_view format, std::uint64_t version) { (void)check_format(format, version, version); }
    /// Call after reading every key; throws for one that was not asked for.
    void finish() const {
        for (const auto& item : json_.items())
            if (!known_.contains(item.key())) fail(item.key(), "unknown key");
    }

    [[noreturn]] void fail(const std::string& key, const std::string& why) const { throw Error(file_, 0, path_of(key), why); }

  private:
    [[nodiscard]] std::string path_of(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }

    std::string file_;
    std::string path_;
    const Json& json_;
    std::set<std::string> known_;
};

[[nodiscard]] inline Json parsed_json(const std::string& file, std::string_view text) {
    try {
        return parse_json(text);
    } catch (const Json::exception& e) {  // a number too large for a double is no parse_error
        throw Error(file, 0, "", fmt::format("no JSON: {}", printable(e.what())));
    }
}

}  // namespace settings
