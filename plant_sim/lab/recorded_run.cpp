#include "plant_sim/lab/recorded_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "firmware/host/seconds.hpp"
#include "firmware/host/settings/settings.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "rig_bridge/replay/measured_signals.hpp"

namespace plant_sim::lab {

namespace {

namespace fs = std::filesystem;

identification::Edges edges(const antiskid::control::SpeedInput& input) {
    return {.count = input.edge_count, .time_s = antiskid::host::seconds(input.edge_time)};
}

/// Counts the readings of a load cell at the end of its field, which say only that the force was not smaller.
class AtEnd {
  public:
    AtEnd(const char* name, const antiskid::can::Signal& field)
        : name_(name), end_N_(std::max(field.value(field.raw_min), field.value(field.raw_max))), half_step_N_(0.5 * std::abs(field.scale)) {}

    void add(double force_N) { count_ += force_N > end_N_ - half_step_N_ ? 1U : 0U; }
    void check(const fs::path& log) const {
        if (count_ <= 3) return;
        throw std::runtime_error(
            fmt::format("{}: {} readings of the {} load cell at the end of their field ({:.0f} N): it saturates; expected a layout that carries the "
                        "rig's forces",
                        log.string(), count_, name_, end_N_));
    }

  private:
    const char* name_;
    double end_N_, half_step_N_;
    std::size_t count_ = 0;
};

}  // namespace

identification::Recording read_recording(const fs::path& log, const antiskid::can::Layout& layout, double period_s) {
    rig::replay::LogWarnings warnings(
        log.string(), [](const std::string& text) { std::fprintf(stderr, "rig-lab: %s\n", text.c_str()); }, 1);
    rig::replay::LogOptions options;
    options.layout = &layout;
    rig::replay::LogReader reader(log, options, warnings);
    rig::replay::MeasuredSignals signals(reader, layout, period_s);
    identification::Recording out{.name = log.parent_path().filename().string(), .period_s = period_s, .samples = {}};
    AtEnd vertical("vertical", layout.load_cells.vertical_N), longitudinal("longitudinal", layout.load_cells.longitudinal_N);
    auto cells_received = antiskid::control::kNever;
    while (signals.next()) {
        const antiskid::can::BusView& view = signals.view();
        // The command of a sample comes after it.
        if (!out.samples.empty()) out.samples.back().current_mA = static_cast<double>(view.controller.current_mA);
        if (view.wheel.source != antiskid::control::SpeedSource::edges || view.flywheel.source != antiskid::control::SpeedSource::edges) {
            throw std::runtime_error(log.string() + ": its encoders report speeds; the identification needs edges with their times");
        }
        out.samples.push_back({.time_s = signals.time_s(),
                               .phase = view.maneuver_state.phase,
                               .current_mA = static_cast<double>(view.controller.current_mA),
                               .pressure_Pa = static_cast<double>(view.pressure.pressure_Pa),
                               .wheel = edges(view.wheel),
                               .flywheel = edges(view.flywheel),
                               .cells_new = view.load_cells_received != cells_received,
                               .vertical_N = static_cast<double>(view.load_cells.vertical_N),
                               .longitudinal_N = static_cast<double>(view.load_cells.longitudinal_N)});
        if (out.samples.back().cells_new) {
            vertical.add(out.samples.back().vertical_N);
            longitudinal.add(out.samples.back().longitudinal_N);
        }
        cells_received = view.load_cells_received;
    }
    vertical.check(log);
    longitudinal.check(log);
    if (out.samples.empty())
        throw std::runtime_error(log.string() + ": no sample of both encoders and pressure in it; expected a bus log of this layout");
    return out;
}

fs::path scenario_of(const fs::path& folder, const fs::path& config) {
    const std::string name = rig::record::read_summary(folder / "summary.json").scenario;
    return config / "scenarios" / (name + ".toml");
}

identification::Run run_of(const rig::Scenario& scenario, const fs::path& config, std::vector<double> map_currents,
                           identification::Recording recording) {
    const rig::RigParameters& rig = scenario.rig.rig;
    if (!scenario.choice.runway.empty())
        throw settings::Error(scenario.files.front().string(), 0, "maneuver.runway",
                              "friction is identified surface by surface; expected a scenario on one");
    if (map_currents.empty()) {
        for (const auto& point : rig.pressure_map.points()) map_currents.push_back(point.current_mA);
    }
    const auto classes = [&] {
        if (scenario.endurance()) return settings::Document::load(config / "flywheel_rig.toml").root().table("endurance").text("friction_class");
        return settings::Document::load(config / "maneuvers.toml").root().table("maneuvers").table(scenario.choice.maneuver).text("friction_class");
    };
    return {.recording = std::move(recording),
            .rig = {.wheel_teeth = rig.wheel_encoder.teeth,
                    .flywheel_teeth = rig.flywheel_encoder.teeth,
                    .flywheel_radius_m = rig.flywheel_radius_m,
                    .mass_kg = rig.wheel.mass_kg,
                    .stiffness_Npm = rig.wheel.stiffness_Npm,
                    .brake_gain_m3 = rig.brake.gain_m3(),
                    .edge_jitter_s = rig.wheel_encoder.jitter_s,
                    .gauge_range_Pa = rig.transducer.range_Pa,
                    .map_currents = std::move(map_currents)},
            .surface = scenario.choice.surface,
            .friction_class = classes()};
}

}  // namespace plant_sim::lab
