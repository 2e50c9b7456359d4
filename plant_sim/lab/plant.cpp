#include <fmt/core.h>

#include <chrono>
#include <memory>

#include "firmware/controller/controller_setup.hpp"
#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/hash.hpp"
#include "firmware/host/settings/json.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/study/validation/plant_validation.hpp"
#include "rig_bridge/rig/load_rig.hpp"
#include "rig_bridge/rig/scenario.hpp"

namespace plant_sim::lab {

namespace {

namespace fs = std::filesystem;

struct PlantCommand {
    std::string log;
    std::string interface;
    fs::path scenario;
    rig::ManeuverChoice choice;
    fs::path config = settings::config_directory();
    fs::path controller, dbc, binding;
    std::string json, csv;
    std::filesystem::path picture;

    /// The rig, and the configuration of the controller that was on it.
    struct Known {
        rig::RigParameters rig;
        fs::path controller;
        std::vector<fs::path> files;
        std::string title;
    };

    [[nodiscard]] Known known() const {
        if (!scenario.empty()) {
            const rig::Scenario s = rig::load_scenario(scenario, config);
            if (!s.choice.runway.empty())
                throw settings::Error(scenario.string(), 0, "maneuver.runway", "a log does not tell where on a runway it was; expected one surface");
            Known k{.rig = s.rig.rig, .controller = s.controller, .files = s.files, .title = s.name};
            if (choice.friction) k.rig.mean_friction = *choice.friction;
            return k;
        }
        const rig::LoadedRig loaded = rig::load_rig(config, choice);
        const bool endurance = choice.maneuver == rig::kEndurance;
        return {.rig = loaded.rig,
                .controller = config / (endurance ? "controller_endurance.toml" : "controller.toml"),
                .files = loaded.files,
                .title = choice.maneuver + " on " + choice.surface};
    }

    [[nodiscard]] antiskid::controller::ControllerSetup setup(const Known& k) const {
        antiskid::controller::Options o;
        o.controller = controller.empty() ? k.controller : controller;
        o.layout = antiskid::LayoutFiles(config, dbc, binding);
        return antiskid::controller::load_setup(o);
    }

    int run() const {
        const Known on_rig = known();
        const antiskid::controller::ControllerSetup loaded = setup(on_rig);
        try {
            compare(on_rig, loaded);
            return 0;
        } catch (const std::exception& e) {
            fmt::print(stderr, "rig-lab: {}\n", e.what());
            return 1;
        }
    }

    void compare(const Known& on_rig, const antiskid::controller::ControllerSetup& loaded) const {
        rig::replay::LogWarnings warnings(log, [](const std::string& text) { fmt::print(stderr, "rig-lab: warning: {}\n", text); });
        rig::replay::LogOptions options;
        if (!interface.empty()) options.interface = interface;
        options.layout = &loaded.layout;
        rig::replay::LogReader reader(log, options, warnings);
        rig::replay::MeasuredSignals signals(reader, loaded.layout, std::chrono::duration<double>(loaded.period).count());
        const validation::Validation v = validation::validate_plant(signals, on_rig.rig);
        if (!v.braked) throw std::runtime_error(log + ": no brake-on in it: no maneuver command that is armed and demands pressure");
        if (json != "-") {
            fmt::print("{}", validation::to_text(v));
            if (warnings.any()) fmt::print("warnings of the log: {}\n", warnings.summary());
        }
        const settings::Json head{{"log", log},
                                  {"rig", on_rig.title},
                                  {"version", ANTISKID_VERSION},
                                  {"config_hash", settings::hash(on_rig.files)},
                                  {"warnings", warnings.summary()}};
        settings::deliver(json, to_json(v, settings::json_line(head)));
        if (!csv.empty()) settings::deliver(csv, to_csv(v));
        if (!picture.empty())
            validation::draw_validation(
                v, picture, fmt::format("{}: recorded against simulated, pressure in feed-forward from {:.1f} m/s", on_rig.title, v.brake_on_mps));
    }
};

}  // namespace

LabVerb plant_verb(CLI::App& lab) {
    const auto c = std::make_shared<PlantCommand>();
    CLI::App* verb = lab.add_subcommand("plant", "The plant under the recorded brake pressure, held against the recorded motion (Fig. 5).");
    settings::existing_file(
        verb->add_option("LOG", c->log, "bus log: candump, Vector ASC or BLF, PEAK TRC, plain or gzip; its first braking is compared"))
        ->required();
    CLI::Option* const by_scenario =
        settings::existing_file(verb->add_option("--scenario", c->scenario, "rig and maneuver: a file of config/scenarios"));
    verb->add_option("--maneuver", c->choice.maneuver, "mass and friction class: a table of maneuvers.toml, or endurance")
        ->excludes(by_scenario)
        ->capture_default_str();
    verb->add_option("--surface", c->choice.surface, "runway, a table of surfaces.toml")->excludes(by_scenario)->capture_default_str();
    verb->add_option("--mass", c->choice.mass_kg, "kg, instead of the maneuver's")->excludes(by_scenario);
    verb->add_option("--mu-b", c->choice.friction, "mean brake friction instead of a new brake's");
    verb->add_option("--speed", c->choice.speed_mps, "m/s, of the brake's friction curve instead of the maneuver's; the start is as recorded");
    settings::add_choice(*verb, "--carrier", c->choice.carrier, {{"aircraft", rig::Carrier::aircraft}, {"flywheel", rig::Carrier::flywheel}},
                         "flywheel: the loading device lags behind eq. (2)");
    settings::add_config_directory(*verb, c->config);
    settings::existing_file(verb->add_option("--controller", c->controller, "its period is that of SYNC (default: that of the maneuver in CONFIG)"));
    settings::add_layout_files(*verb, c->dbc, c->binding);
    verb->add_option("--interface", c->interface, "lines of this interface (default: the first in the log)");
    settings::add_json(*verb, c->json, "errors");
    settings::result_file(verb->add_option("--csv", c->csv, "both motions over time as CSV"));
    settings::add_picture(*verb, c->picture, "speeds, slip and errors");
    verb->footer(
        "Examples:\n"
        "  rig-lab plant out/landing/bus.log --maneuver light --surface wet_asphalt --picture fig5.png\n"
        "  rig-lab plant out/campaign/night/0001/bus.log --scenario config/scenarios/endurance.toml --mu-b 0.27\n"
        "Exit status: 0 compared; 1 the log cannot be read or holds no braking; 2 mistake in command line or configuration.");
    return {verb, [c] { return c->run(); }};
}

}  // namespace plant_sim::lab
