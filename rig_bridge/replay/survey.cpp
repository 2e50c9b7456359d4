#include "rig_bridge/replay/survey.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "rig_bridge/replay/plausibility.hpp"

namespace rig::replay {

std::vector<Channel> wanted_channels(const ImportMap& map) {
    std::vector<Channel> channels;
    for (std::size_t i = 0; i < kChannelCount; ++i)
        if (map.channels[i]) channels.push_back(static_cast<Channel>(i));
    return channels;
}

std::vector<std::string> wanted_columns(const ImportMap& map) {
    std::vector<std::string> columns{map.time.column};
    for (const auto& channel : map.channels)
        if (channel) columns.push_back(channel->column);
    return columns;
}

namespace {

const ImportColumn& column_of(const ImportMap& map, Channel channel) {
    return *map.channels[static_cast<std::size_t>(channel)];
}

void compare_stated(const Recording& recording, const ImportMap& map, std::size_t wanted, const ImportColumn& column, ImportNotes& notes) {
    const std::string stated = recording.stated_unit(wanted);
    const auto unit = antiskid::can::find_unit(stated);
    if (stated.empty() || (unit && *unit == column.unit)) return;
    notes.add("unit", map.unit_row, fmt::format("column '{}' states '{}', the map '{}'", column.column, stated, column.unit_name));
}

/// While the wheel rolls freely its rim goes as fast as the flywheel's: the unit of one is wrong where it does not.
class RollingSurvey {
  public:
    explicit RollingSurvey(const ImportSettings& s)
        : settings_(s),
          wheel_(s.map.channels[0]->unit.factor * s.rig.meter.wheel_radius_m),
          flywheel_(factor_of(Channel::flywheel_speed, s.map.channels[1]->unit, s.rig.meter.flywheel_radius_m)),
          pressure_(s.map.channels[2]->unit.factor) {}

    /// The three channels that every map has come first.
    void add(const RecordedRow& row) {
        const double v_mps = row.values[2] * flywheel_;
        const double rim_mps = row.values[1] * wheel_;
        const bool rolling = row.values[3] * pressure_ < settings_.map.released_Pa && v_mps >= settings_.map.min_speed_mps;
        if (!rolling || !(rim_mps > 0.1 * settings_.map.min_speed_mps)) return;
        sum_ += rim_mps / v_mps;
        ++count_;
    }
    void judge() const {
        constexpr std::uint64_t kEnough = 20;
        constexpr double kNear = 1.2;
        if (count_ < kEnough) return;
        const double ratio = sum_ / static_cast<double>(count_);
        if (ratio > 1.0 / kNear && ratio < kNear) return;
        const ImportColumn& column = *settings_.map.channels[1];
        const std::string likely = units_at_ratio(column, ratio, settings_.rig.meter.flywheel_radius_m);
        throw std::runtime_error(
            fmt::format("{}: without brake pressure the wheel's rim goes {:.3g} times as fast as the "
                        "flywheel's: the unit of column '{}' or "
                        "'{}' is wrong, or the rig is another; {}",
                        settings_.file.string(), ratio, settings_.map.channels[0]->column, column.column,
                        likely.empty() ? "no unit of speed explains it" : "likely unit of '" + column.column + "': " + likely));
    }

  private:
    const ImportSettings& settings_;
    double wheel_, flywheel_, pressure_;
    double sum_ = 0.0;
    std::uint64_t count_ = 0;
};

}  // namespace

void survey_units(const ImportSettings& settings, ImportNotes& notes) {
    const ImportMap& map = settings.map;
    const double radius_m = settings.rig.meter.flywheel_radius_m;
    const std::vector<Channel> channels = wanted_channels(map);
    const auto recording = open_recording(settings.file, map, wanted_columns(map));
    std::vector<ChannelSurvey> surveys;
    compare_stated(*recording, map, 0, map.time, notes);
    for (std::size_t i = 0; i < channels.size(); ++i) {
        const ImportColumn& column = column_of(map, channels[i]);
        compare_stated(*recording, map, i + 1, column, notes);
        surveys.emplace_back(channels[i], factor_of(channels[i], column.unit, radius_m));
    }
    RollingSurvey rolling(settings);
    for (RecordedRow row; recording->next(row);) {
        rolling.add(row);
        for (std::size_t i = 0; i < channels.size(); ++i)
            if (std::isfinite(row.values[i + 1])) surveys[i].add(row.values[i + 1]);
    }
    for (std::size_t i = 0; i < channels.size(); ++i) {
        if (!surveys[i].wrong_unit()) continue;
        const ImportColumn& column = column_of(map, channels[i]);
        const std::string likely = surveys[i].likely_units(column, radius_m);
        throw std::runtime_error(fmt::format("{}: column '{}' ({}) goes from {:g} to {:g}, which cannot be {}; {}", settings.file.string(),
                                             column.column, name(channels[i]), surveys[i].lowest(), surveys[i].highest(), column.unit_name,
                                             likely.empty() ? "no unit of this quantity fits: is it another column?" : "likely unit: " + likely));
    }
    rolling.judge();
}

}  // namespace rig::replay
