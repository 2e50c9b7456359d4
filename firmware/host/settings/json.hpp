/// JSON, by nlohmann's library. The class template is instantiated once, in json.cpp, because that takes seconds per translation unit.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <string_view>

extern template class nlohmann::basic_json<nlohmann::ordered_map>;

namespace settings {

/// Keys keep the order of insertion.
using Json = nlohmann::ordered_json;

/// Throws Json::parse_error, which names the place.
[[nodiscard]] Json parse_json(std::string_view text);

/// json_line(): on one line. json_page(): for result files, indented by two, with a final line feed. Bytes that are not UTF-8 are replaced by U+FFFD;
/// a number that is not finite is written as null.
[[nodiscard]] std::string json_line(const Json& json);
[[nodiscard]] std::string json_page(const Json& json);

}  // namespace settings
