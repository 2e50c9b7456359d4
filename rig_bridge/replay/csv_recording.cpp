#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "firmware/host/settings/csv_field.hpp"
#include "firmware/host/settings/number_in.hpp"
#include "rig_bridge/replay/foreign_log.hpp"
#include "rig_bridge/replay/line_source.hpp"
#include "rig_bridge/replay/recording.hpp"

namespace rig::replay {

namespace {

class CsvRecording final : public Recording {
  public:
    CsvRecording(const std::filesystem::path& file, const ImportMap& map, const std::vector<std::string>& wanted)
        : name_(file.string()), map_(map), wanted_(wanted), source_(file) {
        LineSource::Line line;
        while (source_.lines() + 1 < map_.first_data_row && source_.next(line)) {
            reject_long(line);
            if (line.number == map_.header_row) find_columns(line.text);
            if (line.number == map_.unit_row) find_units(line.text);
        }
        if (places_.empty()) throw std::runtime_error(name_ + ": ends before row " + std::to_string(map_.header_row) + ", the header_row");
    }

    bool next(RecordedRow& row) override {
        LineSource::Line line;
        do {
            if (!source_.next(line)) {
                if (!source_.damage().empty()) throw std::runtime_error(name_ + ":" + std::to_string(source_.lines()) + ": " + source_.damage());
                return false;
            }
            reject_long(line);
        } while (settings::trimmed(line.text).empty());
        row.row = line.number;
        row.unreadable.clear();
        row.values.assign(wanted_.size(), std::numeric_limits<double>::quiet_NaN());
        settings::split_csv(line.text, map_.separator, cells_);
        for (std::size_t i = 0; i < wanted_.size(); ++i) {
            const std::string_view cell = places_[i] < cells_.size() ? cells_[places_[i]] : std::string_view();
            if (!number(cell, row.values[i]))
                row.unreadable.push_back("column " + std::to_string(places_[i] + 1) + " (" + wanted_[i] + "): '" + std::string(cell) + "'");
        }
        return true;
    }

    [[nodiscard]] std::string stated_unit(std::size_t wanted) const override { return wanted < units_.size() ? units_[wanted] : std::string(); }
    [[nodiscard]] double share() const override { return source_.share(); }

  private:
    void reject_long(const LineSource::Line& line) const {
        if (line.too_long)
            throw std::runtime_error(name_ + ":" + std::to_string(line.number) + ": row longer than " + std::to_string(LineSource::kLongest) +
                                     " characters");
    }

    void find_columns(std::string_view line) {
        constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
        if (line.starts_with(kByteOrderMark)) line.remove_prefix(kByteOrderMark.size());
        settings::split_csv(line, map_.separator, cells_);
        for (const std::string& column : wanted_) {
            const auto found = std::find(cells_.begin(), cells_.end(), column);
            if (found == cells_.end()) {
                std::string there;
                for (const std::string_view cell : cells_) there.append(there.empty() ? "" : ", ").append(cell);
                throw std::runtime_error(fmt::format("{}:{}: no column '{}'; there are: {}", name_, map_.header_row, column, there));
            }
            places_.push_back(static_cast<std::size_t>(found - cells_.begin()));
        }
    }

    void find_units(std::string_view line) {
        settings::split_csv(line, map_.separator, cells_);
        for (const std::size_t place : places_) units_.emplace_back(place < cells_.size() ? cells_[place] : std::string_view());
    }

    /// False if the cell has no finite number.
    [[nodiscard]] bool number(std::string_view cell, double& value) {
        text_.assign(cell);
        if (map_.decimal == ',') std::replace(text_.begin(), text_.end(), ',', '.');
        const auto read = settings::number_in<double>(std::string_view(text_).substr(text_.starts_with('+') ? 1 : 0));
        if (!read || !std::isfinite(*read)) return false;
        value = *read;
        return true;
    }

    std::string name_;
    ImportMap map_;
    std::vector<std::string> wanted_;
    LineSource source_;
    std::vector<std::size_t> places_;
    std::vector<std::string> units_;
    std::vector<std::string_view> cells_;
    std::string text_;
};

}  // namespace

std::unique_ptr<Recording> open_recording(const std::filesystem::path& file, const ImportMap& map, const std::vector<std::string>& wanted) {
    reject_mdf(file);
    if (map.mat) return open_mat(file, wanted);
    return std::make_unique<CsvRecording>(file, map, wanted);
}

}  // namespace rig::replay
