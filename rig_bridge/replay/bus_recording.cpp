#include <array>
#include <limits>
#include <utility>

#include "rig_bridge/replay/measured_signals.hpp"
#include "rig_bridge/replay/recording.hpp"
#include "rig_bridge/replay/shaft_speed.hpp"

namespace rig::replay {

namespace {

LogOptions options_of(const ImportMap& map) {
    LogOptions options;
    options.interface = map.interface;
    options.layout = &*map.layout;
    return options;
}

class BusRecording final : public Recording {
  public:
    BusRecording(const std::filesystem::path& file, const ImportMap& map, const record::MeterParameters& rig, LogWarnings::Sink warnings)
        : map_(map),
          name_(file.string()),
          sink_(warnings),
          warnings_(name_, std::move(warnings)),
          reader_(file, options_of(map), warnings_),
          signals_(reader_, *map.layout, rig.period_s),
          wheel_(rig.wheel_teeth),
          flywheel_(rig.flywheel_teeth) {
        taken_.fill(antiskid::control::kNever);
    }

    bool next(RecordedRow& row) override {
        if (!signals_.next()) {
            if (signals_.restarted() && sink_)
                sink_(name_ + ":" + std::to_string(reader_.lines()) +
                      ": SYNC numbers begin anew: another recording, which is not read; import it alone");
            return false;
        }
        row.row = signals_.line();
        row.unreadable.clear();
        row.values.assign(1, signals_.time_s());
        const std::array<double, kChannelCount> now = values();
        for (std::size_t i = 0; i < kChannelCount; ++i)
            if (map_.channels[i]) row.values.push_back(now[i]);
        return true;
    }

    [[nodiscard]] std::string stated_unit(std::size_t) const override { return {}; }
    [[nodiscard]] double share() const override { return reader_.share(); }
    [[nodiscard]] std::string troubles() const override { return warnings_.summary(); }

  private:
    /// In the order of Channel; NaN without a new frame with that value since the row before.
    [[nodiscard]] std::array<double, kChannelCount> values() {
        const antiskid::can::BusView& view = signals_.view();
        const std::array<antiskid::control::Time, kChannelCount> received{
            view.wheel.received,      view.flywheel.received,   view.pressure.received,           view.load_cells_received,
            view.load_cells_received, view.load_cells_received, view.controller.command_received, view.maneuver_state_received};
        std::array<double, kChannelCount> values{wheel_.at(view.wheel, signals_.time_s()),
                                                 flywheel_.at(view.flywheel, signals_.time_s()),
                                                 static_cast<double>(view.pressure.pressure_Pa),
                                                 static_cast<double>(view.load_cells.vertical_N),
                                                 static_cast<double>(view.load_cells.longitudinal_N),
                                                 static_cast<double>(view.load_cells.brake_torque_Nm),
                                                 static_cast<double>(view.controller.current_mA),
                                                 static_cast<double>(view.maneuver_state.brake_temperature_C)};
        for (std::size_t i = 0; i < kChannelCount; ++i)
            if (received[i] == taken_[i]) values[i] = std::numeric_limits<double>::quiet_NaN();
        taken_ = received;
        return values;
    }

    const ImportMap& map_;
    std::string name_;
    LogWarnings::Sink sink_;
    LogWarnings warnings_;
    LogReader reader_;
    MeasuredSignals signals_;
    ShaftSpeed wheel_, flywheel_;
    std::array<antiskid::control::Time, kChannelCount> taken_{};  // stamp of the newest frame of each
};

}  // namespace

std::unique_ptr<Recording> open_bus(const std::filesystem::path& file, const ImportMap& map, const record::MeterParameters& rig,
                                    LogWarnings::Sink warnings) {
    return std::make_unique<BusRecording>(file, map, rig, std::move(warnings));
}

}  // namespace rig::replay
