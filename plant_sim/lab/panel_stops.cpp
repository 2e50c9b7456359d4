#include "plant_sim/lab/panel_stops.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "firmware/can/names.hpp"
#include "firmware/host/settings/json.hpp"
#include "plant_sim/scenario/stop_options.hpp"
#include "plant_sim/study/in_process.hpp"
#include "rig_bridge/panel/curves.hpp"
#include "rig_bridge/rig/load_rig.hpp"

namespace plant_sim::lab {

namespace {

using rig::panel::Curves;
using rig::panel::Field;
using rig::panel::LiveSample;
using rig::panel::Query;
using rig::panel::Signal;

constexpr double kRow_s = 5e-3;
constexpr std::string_view kRunway = "runway ";  // in front of a runway's name, which may be that of a surface

std::filesystem::path runways_of(const std::filesystem::path& config) {
    return config / "runways";
}

/// Every surface, then every runway.
std::vector<std::string> roads(const std::filesystem::path& config) {
    std::vector<std::string> runways;
    if (std::filesystem::is_directory(runways_of(config)))
        for (const auto& file : std::filesystem::directory_iterator(runways_of(config)))
            if (file.path().extension() == ".toml") runways.push_back(std::string(kRunway) + file.path().stem().string());
    std::sort(runways.begin(), runways.end());
    std::vector<std::string> all = rig::surface_names(config);
    all.insert(all.end(), runways.begin(), runways.end());
    return all;
}

void check(const Field& field, const Query& query) {
    if (!field.words.empty()) {
        const std::string word = query.text(field.key);
        if (std::find(field.words.begin(), field.words.end(), word) == field.words.end())
            throw std::invalid_argument(fmt::format("{}: expected one of {}, got '{}'", field.key, fmt::join(field.words, ", "), word));
        return;
    }
    const double value = query.number(field.key);
    if (!(value >= field.min && value <= field.max))
        throw std::invalid_argument(fmt::format("{}: expected {} to {}, got {}", field.key, field.min, field.max, value));
}

LiveSample sample_of(const study::RigSession& session, const antiskid::can::ControllerView& view, double current_mA) {
    const plant::Rig& rig = session.rig();
    const plant::Forces forces = rig.forces();
    LiveSample sample;
    sample[Signal::rim] = rig.wheel().v_mps;
    sample[Signal::wheel] = rig.wheel().omega_radps * forces.radius_m;
    sample[Signal::slip] = forces.slip;
    sample[Signal::slip_reference] = static_cast<double>(view.slip_reference);
    sample[Signal::demand] = static_cast<double>(session.sample().maneuver.demand_Pa);
    sample[Signal::pressure] = rig.pressure_Pa();
    sample[Signal::current] = current_mA;
    sample[Signal::load] = forces.F_z_N;
    return sample;
}

}  // namespace

PanelStops::PanelStops(std::filesystem::path config) : config_(std::move(config)) {
    fields_ = {
        {.key = "maneuver", .label = "landing", .words = rig::maneuver_names(config_), .value = "heavy"},
        {.key = "surface", .label = "surface or runway", .words = roads(config_), .value = "dry_asphalt"},
        {.key = "law", .label = "law", .words = {"slip", "peak_slip", "threshold", "pressure_bias"}, .value = "slip"},
        {.key = "slip", .label = "slip reference", .min = 0.02, .max = 0.5, .step = 0.01, .value = "0.24"},
        {.key = "speed", .label = "speed at brake-on", .unit = "m/s", .min = 20.0, .max = 80.0, .step = 1.0, .value = "61"},
        {.key = "friction", .label = "brake friction (wear lowers it)", .min = 0.15, .max = 0.45, .step = 0.01, .value = "0.30"},
    };
}

std::string PanelStops::stop(const Query& query) {
    const std::unique_lock alone(running_, std::try_to_lock);
    if (!alone) throw rig::panel::Busy("another stop is running");
    for (const Field& field : fields_) check(field, query);
    StopOptions options;
    options.config = config_;
    options.choice.maneuver = query.text("maneuver");
    const std::string road = query.text("surface");
    if (road.starts_with(kRunway))
        options.choice.runway = runways_of(config_) / (road.substr(kRunway.size()) + ".toml");
    else
        options.choice.surface = road;
    options.choice.speed_mps = query.number("speed");
    options.choice.friction = query.number("friction");
    options.law = query.text("law");
    options.slip = query.number("slip");
    const StopInputs inputs = load_scenario(options);
    const double brake_on_s = inputs.session.plan.touchdown_s + inputs.session.plan.settle_s;
    Curves curves;
    double next_s = 0.0;
    const study::RunResult result =
        study::run_in_process(inputs.controller, inputs.layout, inputs.plant.rig, inputs.session, study::Link::rounded,
                              [&](const study::RigSession& session, const antiskid::can::ControllerView& view, double current_mA) {
                                  const double time_s = session.rig().time_s();
                                  if (time_s < next_s) return;
                                  next_s += kRow_s;
                                  LiveSample sample = sample_of(session, view, current_mA);
                                  sample.time_s = time_s - brake_on_s;
                                  curves.add(sample);
                              });
    const study::StopFigures& f = result.figures;
    const settings::Json figures{{"stop distance, m", f.stop_distance_m},
                                 {"time from brake-on, s", f.duration_s},
                                 {"J_mu, eq. (16)", f.j_mu},
                                 {"energy to the brake, MJ", f.energy_brake_J * 1e-6},
                                 {"energy to the tyre, MJ", f.energy_tyre_J * 1e-6},
                                 {"peak slip above drop-out", f.peak_slip},
                                 {"longest lock above drop-out, ms", f.longest_lock_s * 1e3},
                                 {"came to rest", result.came_to_rest ? "yes" : "NO"},
                                 {"faults", fmt::format("{}", fmt::join(antiskid::can::fault_names(result.faults), " "))}};
    return "{\"figures\":" + figures.dump() + ",\"columns\":" + curves.json() + "}";
}

}  // namespace plant_sim::lab
