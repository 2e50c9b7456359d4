#include "plant_sim/scenario/stop_options.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "firmware/host/controller_config.hpp"
#include "firmware/host/layout_files.hpp"
#include "firmware/host/settings/command_line.hpp"
#include "firmware/host/settings/hash.hpp"
#include "plant_sim/study/drive.hpp"
#include "plant_sim/wear/brake_state.hpp"
#include "rig_bridge/rig/same_rig.hpp"

namespace plant_sim {

namespace {

using antiskid::control::Law;

const std::map<std::string, Law>& laws() {
    static const std::map<std::string, Law> kLaws{
        {"slip", Law::wheel_slip},     {"deceleration", Law::deceleration},   {"open_loop", Law::open_loop},
        {"threshold", Law::threshold}, {"pressure_bias", Law::pressure_bias}, {"peak_slip", Law::peak_slip}};
    return kLaws;
}

study::ManeuverPlan plan(const StopOptions& o, const rig::LoadedRig& plant) {
    study::ManeuverPlan plan;
    if (!std::isfinite(o.slip)) throw std::invalid_argument("--slip must be a number from 0 to 0.5");
    constexpr double kMaxDeceleration_mps2 = 15.0;
    if (o.deceleration_mps2 && !(*o.deceleration_mps2 >= 0.0 && *o.deceleration_mps2 <= kMaxDeceleration_mps2)) {
        throw std::invalid_argument(fmt::format("--deceleration must be from 0 to {} m/s2", kMaxDeceleration_mps2));
    }
    plan.law = laws().at(o.law);
    plan.slip_reference = o.slip;
    plan.demand_Pa = plant.full_pressure_Pa;
    plan.deceleration_mps2 = o.deceleration_mps2.value_or(plant.deceleration_mps2);
    if (plan.law == Law::deceleration && plan.deceleration_mps2 <= 0.0) {
        throw std::invalid_argument("--law deceleration needs --deceleration A (m/s2) for this maneuver");
    }
    if (plan.law == Law::open_loop) {
        if (o.profile.empty()) throw std::invalid_argument("--law open_loop needs --profile FILE (time_s,current_mA)");
        const study::DriveProfile profile = study::read_profile(o.profile);
        if (profile.input != study::DriveInput::current_mA) {
            throw std::invalid_argument(o.profile.string() + ": the open-loop law needs the columns time_s,current_mA");
        }
        for (std::size_t i = 0; i < profile.time_s.size(); ++i) plan.current.push_back({profile.time_s[i], profile.value[i]});
    }
    return plan;
}

}  // namespace

void StopOptions::add_to(CLI::App& app) {
    app.add_option("--maneuver", choice.maneuver, "light, medium_a, medium_b, heavy (maneuvers.toml), or endurance")->capture_default_str();
    auto* const surface = app.add_option("--surface", choice.surface, "runway, a table of surfaces.toml")->capture_default_str();
    settings::existing_file(
        app.add_option("--runway", choice.runway, "surfaces over distance, wet friction over speed: a file as config/runways has them"))
        ->excludes(surface);
    settings::one_of(app.add_option("--law", law, "control law"), {"slip", "peak_slip", "threshold", "pressure_bias", "deceleration", "open_loop"})
        ->capture_default_str();
    app.add_option("--slip", slip, "slip reference")->check(CLI::Range(0.0, 0.5))->capture_default_str();
    app.add_option("--deceleration", deceleration_mps2, "reference of the deceleration law, m/s2");
    settings::existing_file(app.add_option("--profile", profile, "current of the open-loop law: CSV time_s,current_mA from brake-on"));
    app.add_option("--mass", choice.mass_kg, "mass on the wheel, kg, instead of the maneuver's");
    app.add_option("--speed", choice.speed_mps, "brake-on speed, m/s, instead of the maneuver's");
    app.add_option("--mu-b", choice.friction, "mean brake friction of this maneuver, whatever the brake");
    settings::existing_file(app.add_option("--friction-curves", choice.friction_curves,
                                           "TOML with [brake.relative_friction] instead of the rig's, as `rig-lab wear dynamics` writes it"));
    settings::add_choice(app, "--carrier", choice.carrier, {{"aircraft", rig::Carrier::aircraft}, {"flywheel", rig::Carrier::flywheel}},
                         "flywheel: the loading device lags behind eq. (2)");
    settings::add_seed(app, seed)->check(CLI::NonNegativeNumber);
    settings::add_config_directory(app, config);
    settings::existing_file(app.add_option(
        "--controller", controller, "controller configuration (default: CONFIG/controller.toml; endurance: CONFIG/controller_endurance.toml)"));
    settings::add_layout_files(app, dbc, binding);
}

StopInputs load_scenario(const StopOptions& o) {
    const bool endurance = o.choice.maneuver == rig::kEndurance;
    const auto controller_file = o.controller.empty() ? o.config / (endurance ? "controller_endurance.toml" : "controller.toml") : o.controller;
    const antiskid::LayoutFiles layout(o.config, o.dbc, o.binding);
    const rig::LoadedRig plant = rig::load_rig(o.config, o.choice);
    const antiskid::control::Config controller = antiskid::load_controller_config(controller_file);
    rig::check_same_rig(plant, controller, controller_file);
    StopInputs s{.plant = plant,
                 .controller = controller,
                 .layout = layout.load(antiskid::required_range(controller)),
                 .session = {},
                 .config_hash = {},
                 .brake = {}};
    if (o.brake.given()) {
        s.brake = o.brake.brake_of(s.plant.wear, o.seed);
        rig::RigParameters& rig = s.plant.rig;
        if (!o.choice.friction) rig.mean_friction = std::max(s.brake->next_friction(), rig::min_mean_friction(rig.friction_curve));
    }
    std::vector<std::filesystem::path> files = s.plant.files;
    files.insert(files.end(), {controller_file, layout.dbc, layout.binding});
    s.config_hash = settings::hash(files);
    s.session.plan = plan(o, s.plant);
    if (!s.layout.maneuver.has(s.session.plan.law))
        throw std::invalid_argument(fmt::format("--law {}: the law's field of {} is too narrow for it", o.law, layout.dbc.string()));
    s.session.period_s = static_cast<double>(s.controller.period_s);
    s.session.drop_out_mps = s.plant.drop_out_mps;
    s.session.seed = o.seed;
    return s;
}

void StopInputs::save_brake(const StopOptions& o, double energy_J) const {
    if (!brake || o.brake.state.empty()) return;
    wear::WearingBrake after = *brake;
    after.take(energy_J);
    wear::write_brake_state(o.brake.state, after.state(), after.wear());
}

study::StopReport StopInputs::report(const StopOptions& o) const {
    return {.maneuver = o.choice.maneuver,
            .surface = o.choice.road(),
            .law = o.law,
            .slip_reference = o.slip,
            .mass_kg = plant.rig.wheel.mass_kg,
            .speed_mps = plant.rig.brake_on_mps,
            .brake_taken_J = brake ? std::optional(brake->state().c_e_J) : std::nullopt,
            .figures = {},
            .faults = {},
            .seed = o.seed,
            .version = ANTISKID_VERSION,
            .config_hash = config_hash};
}

study::StopReport StopInputs::report(const StopOptions& o, const study::RunResult& result) const {
    study::StopReport full = report(o);
    full.figures = result.figures;
    full.faults = result.faults;
    full.frames_sent = result.frames_sent;
    full.frames_received = result.frames_received;
    return full;
}

std::string StopInputs::title(const StopOptions& o) const {
    return fmt::format("{} landing: {:.0f} kg at {:.0f} m/s on {}, law {}, slip reference {:.2f}", o.choice.maneuver, plant.rig.wheel.mass_kg,
                       plant.rig.brake_on_mps, o.choice.road(), o.law, o.slip);
}

}  // namespace plant_sim
