#include <fmt/format.h>

#include <array>
#include <memory>

#include "firmware/host/settings/hash.hpp"
#include "plant_sim/lab/dynamics_report.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "rig_bridge/rig/load_rig.hpp"

namespace plant_sim::lab {

namespace {

wear::Curve curve_in_force(const std::filesystem::path& config, const std::string& friction_class) {
    rig::ManeuverChoice choice;
    for (const std::string& maneuver : rig::maneuver_names(config)) {
        choice.maneuver = maneuver;
        const rig::LoadedRig rig = rig::load_rig(config, choice);
        if (rig.friction_class != friction_class) continue;
        wear::Curve c = rig.rig.friction_curve;
        const double mean = c[0] + c[1] / 2.0 + c[2] / 3.0 + c[3] / 4.0;
        for (double& k : c) k /= mean;
        return c;
    }
    return {1.0, 0.0, 0.0, 0.0};
}

std::string hash_of(const std::vector<ClassDynamics>& classes) {
    std::string bytes;
    for (const ClassDynamics& c : classes) {
        bytes += c.data.friction_class;
        for (const wear::RecordedStop& stop : c.data.stops)
            for (const wear::BrakeSample& s : stop.samples)
                bytes.append(fmt::format("\n{},{},{},{}", s.time_s, s.speed_mps, s.pressure_Pa, s.brake_torque_Nm));
    }
    const std::array<std::string_view, 1> whole{bytes};
    return settings::hash_bytes(whole);
}

struct DynamicsCommand {
    std::vector<std::string> sources;
    StopFiles files;
    wear::DynamicsSettings settings;
    std::filesystem::path out = "out/wear";
    std::string json_file;  ///< "-": standard output
    bool pictures = true;

    int run() {
        files.warn = [](const std::string& line) { fmt::print(stderr, "rig-lab: {}\n", line); };
        std::vector<StopSource> wanted;
        wanted.reserve(sources.size());
        for (const std::string& text : sources) wanted.push_back(parse_source(text));
        std::vector<ClassDynamics> classes;
        for (ClassStops& data : load_stops(wanted, files)) {
            wear::FrictionDynamics found = wear::learn_dynamics(data.stops, settings);
            const wear::Curve in_force = curve_in_force(files.config, data.friction_class);
            classes.push_back({std::move(data), std::move(found), in_force});
        }
        if (classes.empty()) {
            fmt::print(stderr, "rig-lab: no finished maneuver in what was given\n");
            return 2;
        }
        const DynamicsHead head{settings::hash(std::vector<std::filesystem::path>{files.config / "maneuvers.toml", files.config / "landing_gear.toml",
                                                                                  files.config / "flywheel_rig.toml"}),
                                hash_of(classes)};
        print_table(json_file, "{}", to_text(classes));
        write_json(out / "dynamics.json", json_file, to_json(classes, head));
        settings::deliver((out / "friction_curves.toml").string(), to_toml(classes, head));
        if (pictures) draw_dynamics(classes, settings, out / "dynamics.png");
        print_table(json_file,
                    "Written to {0}: dynamics.json friction_curves.toml{1}\nIn force with --friction-curves {0}/friction_curves.toml, or pasted into "
                    "landing_gear.toml.\n",
                    out.string(), pictures ? " dynamics.png" : "");
        return 0;
    }
};

}  // namespace

LabVerb wear_dynamics_verb(CLI::App& wear) {
    const auto command = std::make_shared<DynamicsCommand>();
    CLI::App* verb = wear.add_subcommand("dynamics", "Fig. 6: how friction moves within a stop, learnt from recorded stops by class of maneuver.");
    verb->add_option(
            "SOURCE", command->sources,
            "[CLASS=]PATH: a bus log, a maneuver's folder, a campaign's folder or ledger, or a CSV with time_s, speed_mps, pressure_Pa, "
            "brake_torque_Nm. CLASS: light, medium, heavy, a maneuver of maneuvers.toml, or endurance; may be left out where a summary.json says it")
        ->required();
    verb->add_option("--highest-order", command->settings.highest_order, "of the polynomials that are tried")
        ->check(CLI::Range(std::size_t{0}, std::size_t{3}))
        ->capture_default_str();
    settings::add_config_directory(*verb, command->files.config);
    settings::add_layout_files(*verb, command->files.dbc, command->files.binding);
    settings::add_json(*verb, command->json_file, "results");
    settings::add_out(*verb, command->out, "directory of dynamics.json, friction_curves.toml and dynamics.png");
    settings::add_no_pictures(*verb, command->pictures);
    verb->footer(
        "Examples:\n"
        "  rig-lab wear dynamics runs/light runs/medium runs/heavy\n"
        "  rig-lab wear dynamics heavy=day1.csv heavy=day2.csv light=out/light/bus.log --out out/mine\n"
        "  rig-lab stop --maneuver heavy --friction-curves out/mine/friction_curves.toml\n"
        "Exit status: 0 learnt; 2 a recording or configuration file that cannot be used.");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim::lab
