#include "rig_bridge/wear/csv_rows.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/near_miss.hpp"

namespace wear {

namespace {

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// To the comma that ends the first field; one within quotes does not.
std::size_t end_of_field(std::string_view text) {
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '"') quoted = !quoted;
        if (text[i] == ',' && !quoted) return i;
    }
    return std::string_view::npos;
}

std::string_view content(std::string_view field) {
    const bool quoted = field.size() > 1 && field.starts_with('"') && field.ends_with('"');
    return quoted ? field.substr(1, field.size() - 2) : field;
}

}  // namespace

CsvRows::CsvRows(std::string_view csv) : rest_(csv) {
    if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
}

bool CsvRows::next() {
    while (!rest_.empty()) {
        const auto end = rest_.find('\n');
        std::string_view text = trimmed(rest_.substr(0, end));
        rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
        ++line_;
        if (text.empty() || text.front() == '#') continue;
        fields_.clear();
        for (;;) {
            const auto comma = end_of_field(text);
            fields_.push_back(content(trimmed(text.substr(0, comma))));
            if (comma == std::string_view::npos) return true;
            text.remove_prefix(comma + 1);
        }
    }
    return false;
}

double csv_number(const std::string& file, unsigned line, std::string_view column, std::string_view field) {
    double value = 0.0;
    const char* const end = field.data() + field.size();
    const auto [at, failure] = std::from_chars(field.data(), end, value);
    if (failure != std::errc() || at != end || !std::isfinite(value))
        throw settings::Error(file, line, std::string(column),
                              field.empty()
                                  ? std::string("no value")
                                  : fmt::format("'{}' is no finite number", settings::printable(field)));
    return value;
}

}  // namespace wear
