#include "plant_sim/lab/recorded_run.hpp"

#include <cstdio>
#include <stdexcept>

#include "firmware/can/observer.hpp"
#include "firmware/host/settings/settings.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "rig_bridge/replay/log_reader.hpp"

namespace plant_sim {

namespace {

namespace fs = std::filesystem;
using antiskid::can::Role;

double to_seconds(antiskid::control::Time t) {
    return static_cast<double>(t.count()) * 1e-9;
}

rig::LogOptions options(const antiskid::can::Layout& layout) {
    rig::LogOptions o;
    o.layout = &layout;
    return o;
}

bool has_sync(const fs::path& log, const antiskid::can::Layout& layout) {
    if (!layout[Role::sync].bound) return false;
    constexpr int kAhead = 2000;
    rig::LogWarnings warnings(
        log.string(), [](const std::string&) {}, 0);
    rig::LogReader reader(log, options(layout), warnings);
    rig::LogFrame frame;
    for (int i = 0; i < kAhead && reader.next(frame); ++i) {
        if (frame.frame.id == layout[Role::sync].id) return true;
    }
    return false;
}

/// Times of samples: from SYNC numbers, or from stamps.
class Clock {
  public:
    Clock(bool lockstep, const antiskid::can::Layout& layout, double period_s)
        : lockstep_(lockstep),
          mask_(layout.sync_counter.bound() ? layout.sync_counter.mask() : 0),
          period_s_(period_s) {}

    /// False where this is no new sample: a SYNC that was repeated, a stamp that does not rise.
    bool advance(const antiskid::can::BusView& view, antiskid::control::Time stamp) {
        const double before_s = time_s_;
        if (!lockstep_) {
            if (!started_) first_ = stamp;
            time_s_ = to_seconds(stamp - first_);
        } else if (started_) {
            const std::uint64_t moved = mask_ == 0 ? 1 : (view.sync_number - number_) & mask_;
            time_s_ += static_cast<double>(moved) * period_s_;
        }
        number_ = view.sync_number;
        const bool fresh = !started_ || time_s_ > before_s;
        if (!fresh) time_s_ = before_s;
        started_ = true;
        return fresh;
    }
    [[nodiscard]] double time_s() const { return time_s_; }

  private:
    bool lockstep_;
    std::uint64_t mask_;
    double period_s_;
    bool started_ = false;
    std::uint64_t number_ = 0;
    antiskid::control::Time first_{};
    double time_s_ = 0.0;
};

identification::Edges edges(const antiskid::control::SpeedInput& input) {
    return {.count = input.edge_count, .time_s = to_seconds(input.edge_time)};
}

}  // namespace

identification::Recording read_recording(const fs::path& log, const antiskid::can::Layout& layout,
                                         double period_s) {
    const bool lockstep = has_sync(log, layout);
    const Role ends = lockstep ? Role::sync : Role::pressure;
    rig::LogWarnings warnings(
        log.string(), [](const std::string& text) { std::fprintf(stderr, "rig-lab: %s\n", text.c_str()); },
        1);
    rig::LogReader reader(log, options(layout), warnings);
    antiskid::can::Observer observer(layout);
    Clock clock(lockstep, layout, period_s);
    identification::Recording out{
        .name = log.parent_path().filename().string(), .period_s = period_s, .samples = {}};
    bool cells_new = false;
    for (rig::LogFrame frame; reader.next(frame);) {
        const auto role = observer.accept(frame.frame);
        if (role == Role::load_cells) cells_new = true;
        if (role != ends) continue;
        const antiskid::can::BusView& view = observer.view();
        // The command of a sample comes after it.
        if (!out.samples.empty())
            out.samples.back().current_mA = static_cast<double>(view.controller.current_mA);
        const bool complete = view.wheel.received != antiskid::control::kNever &&
                              view.flywheel.received != antiskid::control::kNever &&
                              view.pressure.received != antiskid::control::kNever;
        if (!clock.advance(view, frame.frame.received) || !complete) continue;
        if (view.wheel.source != antiskid::control::SpeedSource::edges ||
            view.flywheel.source != antiskid::control::SpeedSource::edges) {
            throw std::runtime_error(
                log.string() +
                ": its encoders report speeds; the identification needs edges with their times");
        }
        out.samples.push_back({.time_s = clock.time_s(),
                               .phase = view.maneuver_state.phase,
                               .current_mA = static_cast<double>(view.controller.current_mA),
                               .pressure_Pa = static_cast<double>(view.pressure.pressure_Pa),
                               .wheel = edges(view.wheel),
                               .flywheel = edges(view.flywheel),
                               .cells_new = cells_new,
                               .vertical_N = static_cast<double>(view.load_cells.vertical_N),
                               .longitudinal_N = static_cast<double>(view.load_cells.longitudinal_N)});
        cells_new = false;
    }
    if (out.samples.empty())
        throw std::runtime_error(
            log.string() +
            ": no sample of both encoders and pressure in it; expected a bus log of this layout");
    return out;
}

fs::path scenario_of(const fs::path& folder, const fs::path& config) {
    const std::string name = rig::read_summary(folder / "summary.json").scenario;
    return config / "scenarios" / (name + ".toml");
}

identification::Run run_of(const rig::Scenario& scenario, const fs::path& config,
                           std::vector<double> map_currents, identification::Recording recording) {
    const plant::RigParameters& rig = scenario.rig.rig;
    if (!scenario.choice.runway.empty())
        throw settings::Error(scenario.files.front().string(), 0, "maneuver.runway",
                              "friction is identified surface by surface; expected a scenario on one");
    if (map_currents.empty()) {
        for (const auto& point : rig.pressure_map.points()) map_currents.push_back(point.current_mA);
    }
    const auto classes = [&] {
        if (scenario.endurance())
            return settings::Document::load(config / "flywheel_rig.toml")
                .root()
                .table("endurance")
                .text("friction_class");
        return settings::Document::load(config / "maneuvers.toml")
            .root()
            .table("maneuvers")
            .table(scenario.choice.maneuver)
            .text("friction_class");
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

}  // namespace plant_sim
