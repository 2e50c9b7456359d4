/// Text as a field of a CSV.
#pragma once

#include <string>
#include <string_view>

namespace settings {

/// By RFC 4180: in quotes, its own ones doubled, where it holds a separator, a quote or a line end, begins with # or has blanks at an end.
[[nodiscard]] inline std::string csv_field(std::string_view text) {
    const bool plain = text.find_first_of(",\"\r\n") == std::string_view::npos && !text.starts_with('#') &&
                       !text.starts_with(' ') && !text.ends_with(' ');
    if (plain) return std::string(text);
    std::string quoted = "\"";
    for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
    return quoted + '"';
}

}  // namespace settings
