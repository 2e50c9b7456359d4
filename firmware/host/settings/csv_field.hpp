/// Writes text as a CSV field, and splits a CSV line into fields.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace settings {

/// RFC 4180: quoted, with inner quotes doubled, if the text contains a comma, a quote or a line end, begins with # or has a blank at either end.
[[nodiscard]] inline std::string csv_field(std::string_view text) {
    const bool plain =
        text.find_first_of(",\"\r\n") == std::string_view::npos && !text.starts_with('#') && !text.starts_with(' ') && !text.ends_with(' ');
    if (plain) return std::string(text);
    std::string quoted = "\"";
    for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
    return quoted + '"';
}

/// `text` without blanks, tabs and carriage returns at its ends.
[[nodiscard]] inline std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// Splits a line into trimmed fields, as views into `line`. A quoted field may contain separators; its outer quotes are removed, doubled quotes stay
/// doubled.
inline void split_csv(std::string_view line, char separator, std::vector<std::string_view>& fields) {
    fields.clear();
    for (std::size_t from = 0; from <= line.size();) {
        const std::size_t begin = line.find_first_not_of(' ', from);
        const bool quoted = begin != std::string_view::npos && line[begin] == '"';
        std::size_t closing = quoted ? line.find('"', begin + 1) : from;
        while (quoted && closing != std::string_view::npos && line.substr(closing).starts_with("\"\"")) closing = line.find('"', closing + 2);
        if (closing == std::string_view::npos) closing = from;
        const std::size_t end = std::min(line.find(separator, closing), line.size());
        std::string_view field = trimmed(line.substr(from, end - from));
        if (field.size() >= 2 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
        fields.push_back(field);
        from = end + 1;
    }
}

}  // namespace settings
