/// JSON by nlohmann's library. Its class is compiled once, in json.cpp: in each unit that uses it that takes seconds.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <string_view>

extern template class nlohmann::basic_json<nlohmann::ordered_map>;

namespace settings {

/// Keys stay in the order in which they were written.
using Json = nlohmann::ordered_json;

/// Throws Json::parse_error, which names the place.
[[nodiscard]] Json parse_json(std::string_view text);

/// On one line, and, for a file of results, indented by two with a line feed at its end. What is no UTF-8, in a name or a message, is
/// replaced by U+FFFD.
[[nodiscard]] std::string json_line(const Json& json);
[[nodiscard]] std::string json_page(const Json& json);

}  // namespace settings
