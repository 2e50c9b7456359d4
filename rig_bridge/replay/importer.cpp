#include "rig_bridge/replay/importer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <stdexcept>

#include "rig_bridge/record/summary_file.hpp"
#include "rig_bridge/replay/plausibility.hpp"

namespace rig::replay {

using rig::Phase;

namespace {

/// The map's channels, in the order of Channel.
std::vector<Channel> wanted_channels(const ImportMap& map) {
    std::vector<Channel> channels;
    for (std::size_t i = 0; i < kChannelCount; ++i)
        if (map.channels[i]) channels.push_back(static_cast<Channel>(i));
    return channels;
}

/// The columns of `map`: time, then its channels.
std::vector<std::string> wanted_columns(const ImportMap& map) {
    std::vector<std::string> columns{map.time.column};
    for (const auto& channel : map.channels)
        if (channel) columns.push_back(channel->column);
    return columns;
}

const ImportColumn& column_of(const ImportMap& map, Channel channel) {
    return *map.channels[static_cast<std::size_t>(channel)];
}

void compare_stated(const Recording& recording, const ImportMap& map, std::size_t wanted, const ImportColumn& column, ImportNotes& notes) {
    const std::string stated = recording.stated_unit(wanted);
    const auto unit = antiskid::can::find_unit(stated);
    if (stated.empty() || (unit && *unit == column.unit)) return;
    notes.add("unit", map.unit_row, fmt::format("column '{}' states '{}', the map '{}'", column.column, stated, column.unit_name));
}

/// `warnings`: about single frames of a log.
std::unique_ptr<Recording> open(const ImportSettings& settings, const LogWarnings::Sink& warnings) {
    if (settings.map.layout) return open_bus(settings.file, settings.map, settings.rig.meter, warnings);
    return open_recording(settings.file, settings.map, wanted_columns(settings.map));
}

/// Reports the progress of one of the two passes.
class Reading {
  public:
    Reading(const ImportSettings& settings, const Recording& recording, double before)
        : settings_(settings), recording_(recording), before_(before) {}
    void row() {
        constexpr std::uint64_t kEvery = 4096;
        if (settings_.progress && ++rows_ % kEvery == 0) settings_.progress(before_ + 0.5 * recording_.share());
    }

  private:
    const ImportSettings& settings_;
    const Recording& recording_;
    double before_;
    std::uint64_t rows_ = 0;
};

/// While the wheel rolls freely its rim is as fast as the flywheel's; otherwise the unit of one of them is wrong.
class RollingSurvey {
  public:
    explicit RollingSurvey(const ImportSettings& s)
        : settings_(s),
          wheel_(s.map.channels[0]->unit.factor * s.rig.meter.wheel_radius_m),
          flywheel_(factor_of(Channel::flywheel_speed, s.map.channels[1]->unit, s.rig.meter.flywheel_radius_m)),
          pressure_(s.map.channels[2]->unit.factor) {}

    /// Every map has the three channels that come first.
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
            fmt::format("{}: without brake pressure the wheel's rim goes {:.3g} times as fast as the flywheel's: the unit of column '{}' or '{}' is "
                        "wrong, or the rig is another; {}",
                        settings_.file.string(), ratio, settings_.map.channels[0]->column, column.column,
                        likely.empty() ? "no unit of speed explains it" : "likely unit of '" + column.column + "': " + likely));
    }

  private:
    const ImportSettings& settings_;
    double wheel_, flywheel_, pressure_;
    double sum_ = 0.0;
    std::uint64_t count_ = 0;
};

/// The field that carries the channel in our log; null: it is told by edges.
const antiskid::can::Signal* field_of(const antiskid::can::Layout& layout, Channel channel) {
    switch (channel) {
        case Channel::pressure:
            return &layout.pressure_Pa;
        case Channel::vertical_load:
            return &layout.load_cells.vertical_N;
        case Channel::longitudinal_force:
            return &layout.load_cells.longitudinal_N;
        case Channel::brake_torque:
            return &layout.load_cells.brake_torque_Nm;
        default:
            return nullptr;
    }
}

/// A value beyond its field would be written as the field's end, and the figures would be those of another brake.
void check_fits(const ImportSettings& settings, const ImportColumn& column, Channel channel, double value) {
    const antiskid::can::Signal* const field = field_of(settings.rig.layout, channel);
    if (field == nullptr || !field->bound()) return;
    const auto [min, max] = std::minmax({field->value(field->raw_min), field->value(field->raw_max)});
    const double noise = 0.01 * (max - min);
    if (value >= min - noise && value <= max + noise) return;
    throw std::runtime_error(
        fmt::format("{}: column '{}' ({}) has {:g} (SI), but its field in the layout goes from {:g} to {:g}; expected a layout "
                    "with a wider field (--dbc, --binding)",
                    settings.file.string(), column.column, name(channel), value, min, max));
}

/// Throws std::runtime_error naming the column, its values and the likely unit.
void survey_units(const ImportSettings& settings, ImportNotes& notes) {
    const ImportMap& map = settings.map;
    const double radius_m = settings.rig.meter.flywheel_radius_m;
    const std::vector<Channel> channels = wanted_channels(map);
    const auto recording = open(settings, {});
    std::vector<ChannelSurvey> surveys;
    std::vector<std::pair<double, double>> extremes(channels.size());  // of the plausible values, and 0
    compare_stated(*recording, map, 0, map.time, notes);
    for (std::size_t i = 0; i < channels.size(); ++i) {
        const ImportColumn& column = column_of(map, channels[i]);
        compare_stated(*recording, map, i + 1, column, notes);
        surveys.emplace_back(channels[i], factor_of(channels[i], column.unit, radius_m));
    }
    RollingSurvey rolling(settings);
    Reading reading(settings, *recording, 0.0);
    for (RecordedRow row; recording->next(row);) {
        reading.row();
        rolling.add(row);
        for (std::size_t i = 0; i < channels.size(); ++i)
            if (const double value = row.values[i + 1]; std::isfinite(value) && surveys[i].add(value))
                extremes[i] = {std::min(extremes[i].first, value), std::max(extremes[i].second, value)};
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
    for (std::size_t i = 0; i < channels.size(); ++i)
        for (const double recorded : {extremes[i].first, extremes[i].second})
            check_fits(settings, column_of(map, channels[i]), channels[i], recorded * surveys[i].factor());
}

constexpr double kReleased_s = 0.5;
constexpr double kNever_s = -std::numeric_limits<double>::infinity();
constexpr double kLatest_s = 8.9e9;  // a log has times up to 9e9 s

class Importer {
  public:
    Importer(const ImportSettings& settings, ImportNotes& notes)
        : settings_(settings), map_(settings.map), notes_(notes), rig_(settings.rig), channels_(wanted_channels(map_)) {
        for (const Channel channel : channels_)
            factors_.push_back(factor_of(channel, map_.channels[static_cast<std::size_t>(channel)]->unit, rig_.meter.flywheel_radius_m));
        heard_s_.fill(kNever_s);
    }

    ImportReport run() {
        const auto recording = open(settings_, [this](const std::string& text) { notes_.say(text); });
        Reading reading(settings_, *recording, 0.5);
        for (RecordedRow row; recording->next(row);) {
            reading.row();
            ++report_.rows;
            for (const std::string& cell : row.unreadable) notes_.add("not_a_number", row.row, cell);
            take(row);
        }
        broken();
        report_.log_troubles = recording->troubles();
        return report_;
    }

  private:
    void take(const RecordedRow& row) {
        row_ = row.row;
        if (!std::isfinite(row.values[0])) return;
        ImportSample sample;
        sample.time_s = row.values[0] * map_.time.unit.factor * 1e-9 + shift_s_;
        if (started_ && sample.time_s <= newest_.time_s) {
            const double back_s = newest_.time_s - sample.time_s;
            notes_.add(back_s == 0.0 ? "time_repeated" : "time_reset", row_, fmt::format("by {:g} s", back_s));
            if (back_s == 0.0) return;
            broken();
            heard_s_.fill(kNever_s);
        } else if (started_ && sample.time_s - newest_.time_s > map_.longest_gap_s) {
            notes_.add("gap", row_, fmt::format("{:g} s since the row before", sample.time_s - newest_.time_s));
            broken();
        }
        if (sample.time_s < 0.0 || sample.time_s > kLatest_s) shift(sample);
        for (std::size_t i = 0; i < channels_.size(); ++i) set(row, i, sample);
        const bool measured = listen(sample);
        newest_ = sample;
        started_ = true;
        if (measured) follow(sample);
    }

    /// A channel holds its last number for longest_gap_s, so that a table of fast channels may have slow ones. False: a speed or the pressure is not
    /// known, as in a gap.
    bool listen(ImportSample& sample) {
        bool measured = true;
        for (const Channel channel : channels_) {
            const auto place = static_cast<std::size_t>(channel);
            const double since_s = sample.time_s - heard_s_[place];
            const bool silent = since_s > map_.longest_gap_s;
            const bool begins = silent && !silent_[place];
            silent_[place] = silent;
            if (!silent || channel == Channel::brake_temperature) continue;
            if (begins && std::isfinite(since_s))
                notes_.add("silent", row_,
                           fmt::format("column '{}' has had no number for {:.3g} s; longest_gap_s is {:g}", column_of(map_, channel).column, since_s,
                                       map_.longest_gap_s));
            if (is_load_cell(channel)) sample.load_cells = false;
            if (!is_needed(channel)) continue;
            if (begins) broken();
            measured = false;
        }
        return measured;
    }

    static bool is_needed(Channel channel) {
        return channel == Channel::wheel_speed || channel == Channel::flywheel_speed || channel == Channel::pressure;
    }

    static bool is_load_cell(Channel channel) {
        return channel == Channel::vertical_load || channel == Channel::longitudinal_force || channel == Channel::brake_torque;
    }

    /// From here on times begin near 0, because no log can have this one. Whole seconds keep the milliseconds where they were.
    void shift(ImportSample& sample) {
        const double by_s = -std::floor(sample.time_s);
        shift_s_ += by_s;
        sample.time_s += by_s;
        notes_.add("time_shifted", row_,
                   fmt::format("by {:.0f} s from here on, because the times of a log go from 0 to {:g} s", shift_s_, kLatest_s));
    }

    /// A cell without a plausible number keeps the channel's last value for the time being: listen().
    void set(const RecordedRow& row, std::size_t i, ImportSample& sample) {
        const auto place = static_cast<std::size_t>(channels_[i]);
        const double value = row.values[i + 1] * factors_[i];
        const PlausibleRange& range = plausible(channels_[i]);
        sample.value[place] = newest_.value[place];
        if (!std::isfinite(value)) return;
        if (value >= range.lowest && value <= range.highest) {
            sample.value[place] = value;
            heard_s_[place] = sample.time_s;
            return;
        }
        const ImportColumn& column = *map_.channels[place];
        notes_.add("implausible", row.row, fmt::format("column '{}': {:g} {}", column.column, row.values[i + 1], column.unit_name));
    }

    void follow(const ImportSample& s) {
        const double v_mps = s[Channel::flywheel_speed];
        const double pressure_Pa = s[Channel::pressure];
        if (writer_ == nullptr) {
            remember(s);
            if (pressure_Pa < map_.brake_on_Pa) ready_ = true;
            if (ready_ && pressure_Pa >= map_.brake_on_Pa && v_mps >= map_.min_speed_mps) begin();
            return;
        }
        if (phase_ == Phase::braking && v_mps <= map_.standstill_mps) {
            phase_ = Phase::standstill;
            stood_s_ = s.time_s;
        }
        if (pressure_Pa >= map_.released_Pa) pressed_s_ = s.time_s;
        writer_->add(s, phase_);
        if (phase_ == Phase::standstill && s.time_s - stood_s_ >= map_.after_s)
            end("finished");
        else if (phase_ == Phase::braking && s.time_s - pressed_s_ > kReleased_s)
            end("released");
    }

    void remember(const ImportSample& s) {
        before_.push_back(s);
        while (s.time_s - before_.front().time_s > map_.before_s) before_.pop_front();
    }

    void begin() {
        ++rig_.number;
        ready_ = false;
        maneuver_ = {.folder = settings_.out / fmt::format("{:04}", rig_.number), .outcome = {}, .first_row = row_, .figures = {}};
        writer_ = std::make_unique<ManeuverWriter>(rig_, maneuver_.folder);
        const ImportSample on = before_.back();
        if (on.time_s - before_.front().time_s < 0.1)
            notes_.add("late_start", row_, "less than 0.1 s of the recording lies before brake-on: its speed is uncertain");
        before_.pop_back();
        for (const ImportSample& s : before_) writer_->add(s, Phase::settling);
        before_.clear();
        phase_ = Phase::braking;
        pressed_s_ = on.time_s;
        writer_->add(on, phase_);
    }

    void broken() {
        if (writer_ != nullptr) {
            const bool stood = phase_ == Phase::standstill;
            notes_.add("recording_broken", row_, maneuver_.folder.filename().string() + (stood ? " at standstill" : " while braking"));
            end(stood ? "finished" : "recording_broken");
        }
        before_.clear();
        ready_ = false;
    }

    /// Likely unit of the pressure, if torque over pressure does not fit the brake.
    [[nodiscard]] std::string likely_unit() const {
        if (!(rig_.meter.friction > 0.0)) return {};
        const ImportColumn& column = *map_.channels[static_cast<std::size_t>(Channel::pressure)];
        const std::string units = pressure_units_at_ratio(column, maneuver_.figures.mean_friction / rig_.meter.friction);
        return units.empty() ? "" : fmt::format("; is column '{}' in {}, not {}?", column.column, units, column.unit_name);
    }

    void end(const std::string& outcome) {
        ImportSample last = newest_;
        // The phase that ends the figures, long enough to be noticed.
        for (int i = 1; i <= 20; ++i) {
            last.time_s += 1e-3;
            writer_->add(last, outcome == "finished" ? Phase::retract : Phase::aborting);
        }
        writer_->finish();
        maneuver_.outcome = outcome;
        maneuver_.figures = writer_->figures();
        record::Summary summary;
        summary.figures = maneuver_.figures;
        summary.warnings = writer_->warnings();
        for (const std::string& warning : summary.warnings)
            notes_.add("figures", maneuver_.first_row, warning + (warning.starts_with(record::kFrictionImplausible) ? likely_unit() : ""));
        energy_J_ += record::counted_energy_J(summary);
        summary.campaign = settings_.out.filename().string();
        summary.number = rig_.number;
        summary.scenario = map_.scenario;
        summary.specimen = settings_.specimen;
        summary.outcome = outcome;
        summary.started = fmt::format("row {} of {}", maneuver_.first_row, settings_.file.filename().string());
        summary.cumulative_energy_J = energy_J_;
        summary.frames = writer_->frames();
        summary.version = ANTISKID_VERSION;
        summary.config_hash = settings_.config_hash;
        record::write_summary(maneuver_.folder / "summary.json", summary);
        report_.maneuvers.push_back(maneuver_);
        writer_.reset();
    }

    const ImportSettings& settings_;
    const ImportMap& map_;
    ImportNotes& notes_;
    ImportedRig rig_;
    std::vector<Channel> channels_;
    std::vector<double> factors_;
    ImportReport report_;
    double shift_s_ = 0.0;  // from the recording's times to those of the logs
    bool started_ = false;
    bool ready_ = false;  // the pressure has been below brake-on
    std::uint64_t row_ = 0;
    ImportSample newest_;
    std::array<double, kChannelCount> heard_s_{};  // the last number of each channel
    std::array<bool, kChannelCount> silent_{};
    std::deque<ImportSample> before_;
    std::unique_ptr<ManeuverWriter> writer_;
    ImportedManeuver maneuver_;
    Phase phase_ = Phase::idle;
    double stood_s_ = 0.0, pressed_s_ = 0.0, energy_J_ = 0.0;
};

}  // namespace

ImportReport import_recording(const ImportSettings& settings, ImportNotes& notes) {
    record::check_texts(settings.specimen);
    if (std::filesystem::exists(settings.out / "0001"))
        throw std::runtime_error(settings.out.string() + ": holds maneuvers already; choose another folder");
    survey_units(settings, notes);
    return Importer(settings, notes).run();
}

}  // namespace rig::replay
