#include "rig_bridge/wear/csv_rows.hpp"

#include <fmt/format.h>

#include <cmath>

#include "firmware/host/settings/csv_field.hpp"
#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/near_miss.hpp"
#include "firmware/host/settings/number_in.hpp"

namespace wear {

CsvRows::CsvRows(std::string_view csv) : rest_(csv) {
    if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
}

bool CsvRows::next() {
    while (!rest_.empty()) {
        const auto end = rest_.find('\n');
        std::string_view text = settings::trimmed(rest_.substr(0, end));
        rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
        ++line_;
        if (text.empty() || text.front() == '#') continue;
        settings::split_csv(text, ',', fields_);
        return true;
    }
    return false;
}

double csv_number(const std::string& file, unsigned line, std::string_view column, std::string_view field) {
    const auto value = settings::number_in<double>(field);
    if (!value || !std::isfinite(*value))
        throw settings::Error(file, line, std::string(column),
                              field.empty() ? std::string("no value") : fmt::format("'{}' is no finite number", settings::printable(field)));
    return *value;
}

}  // namespace wear
