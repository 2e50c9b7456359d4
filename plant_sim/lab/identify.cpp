#include <fmt/core.h>
#include <unistd.h>

#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>

#include "firmware/host/controller_config.hpp"
#include "firmware/host/layout_files.hpp"
#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/hash.hpp"
#include "firmware/host/settings/json.hpp"
#include "plant_sim/lab/identify_pictures.hpp"
#include "plant_sim/lab/recorded_run.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/study/validation/plant_validation.hpp"

namespace plant_sim::lab {

namespace {

namespace fs = std::filesystem;
using identification::Identified;
using identification::Run;

struct Validated {
    std::string run;
    validation::Validation result;
};

/// Stops with brake pressure show friction and k_b; the class of the fastest is the one whose k_b is found.
std::string fastest_class(const std::vector<Run>& recorded) {
    std::string name;
    double fastest_mps = 0.0;
    const double age_s = identification::cell_age_s(recorded);
    for (const Run& run : recorded) {
        const auto motion = identification::Motion::of(run, age_s);
        if (!motion || motion->brake_on_mps() <= fastest_mps) continue;
        fastest_mps = motion->brake_on_mps();
        name = run.friction_class;
    }
    return name;
}

struct IdentifyCommand {
    std::vector<fs::path> runs;
    fs::path scenario;
    fs::path config = settings::config_directory();
    fs::path out = "out/identify";
    std::string json_file;  ///< "-": standard output
    fs::path validate;
    std::vector<double> currents;
    bool pictures = true;

    struct Source {
        fs::path log;
        fs::path scenario_file;
        rig::Scenario scenario;
    };

    [[nodiscard]] Source source(const fs::path& run) const {
        const bool folder = fs::is_directory(run);
        const fs::path file = scenario.empty() ? scenario_of(folder ? run : run.parent_path(), config) : scenario;
        return {.log = folder ? run / "bus.log" : run, .scenario_file = file, .scenario = rig::load_scenario(file, config)};
    }

    static void say(const std::string& stage) {
        if (::isatty(STDERR_FILENO) == 1) fmt::print(stderr, "{} ...\n", stage);
    }

    [[nodiscard]] Identified identify(const std::vector<Run>& recorded) const {
        constexpr double kLanding_mps = 20.0;
        std::vector<identification::Recording> recordings;
        recordings.reserve(recorded.size());
        for (const Run& run : recorded) recordings.push_back(run.recording);
        say("valve");
        Identified found{.valve = identification::fit_valve(recordings, recorded.front().rig), .wheel = {}, .surfaces = {}};
        say("wheel and brake");
        found.wheel = identification::fit_wheel(recorded, fastest_class(recorded));
        say("friction");
        std::set<std::string> surfaces;
        const double age_s = identification::cell_age_s(recorded);
        for (const Run& run : recorded) {
            const auto motion = identification::Motion::of(run, age_s);
            if (motion && motion->brake_on_mps() > kLanding_mps) surfaces.insert(run.surface);
        }
        for (const std::string& surface : surfaces) found.surfaces.push_back(identification::fit_friction(recorded, surface));
        return found;
    }
    [[nodiscard]] Validated replay(const Source& source, const antiskid::can::Layout& layout, double period_s) const {
        const rig::Scenario identified = rig::load_scenario(source.scenario_file, out / "config");
        rig::replay::LogWarnings warnings(
            source.log.string(), [](const std::string&) {}, 0);
        rig::replay::LogOptions options;
        options.layout = &layout;
        rig::replay::LogReader reader(source.log, options, warnings);
        rig::replay::MeasuredSignals signals(reader, layout, period_s);
        return {.run = source.log.parent_path().filename().string(), .result = validation::validate_plant(signals, identified.rig.rig)};
    }
    /// The stop that was asked for; else that of the fastest half whose slip lies beyond the peak least: there feed-forward of pressure holds no
    /// wheel, whatever the model is worth.
    [[nodiscard]] std::optional<Validated> validated(const std::vector<Source>& sources, const antiskid::can::Layout& layout, double period_s) const {
        if (!validate.empty()) return replay(source(validate), layout, period_s);
        constexpr double kLanding_mps = 15.0;
        std::optional<Validated> best;
        for (const Source& s : sources) {
            if (s.scenario.mean.speed_mps < kLanding_mps) continue;
            Validated v = replay(s, layout, period_s);
            if (v.result.braked && (!best || v.result.past_peak < best->result.past_peak)) best = std::move(v);
        }
        return best;
    }
    void draw(const Identified& found, const std::optional<Validated>& validation) const {
        say("pictures");
        (void)draw_identified(found, out);
        std::vector<rig::Surface> surfaces;
        std::vector<std::string> names;
        for (const std::string& name : rig::surface_names(out / "config")) {
            rig::ManeuverChoice choice;
            choice.surface = name;
            surfaces.push_back(rig::load_rig(out / "config", choice).rig.surface);
        }
        names.reserve(found.surfaces.size());
        for (const auto& f : found.surfaces) names.push_back(f.surface);
        draw_surfaces(surfaces, names, out / "friction_curves.png");
        if (!validation || !validation->result.braked) return;
        settings::write_file(out / "validation.csv", validation::to_csv(validation->result));
        validation::draw_validation(validation->result, out / "validation.png",
                                    fmt::format("{}: recorded against simulated with what was identified, from {:.1f} m/s", validation->run,
                                                validation->result.brake_on_mps));
    }
    [[nodiscard]] int run() const {
        if (fs::exists(out / "config"))
            throw std::runtime_error((out / "config").string() + " exists already; expected --out with a folder of its own");
        std::vector<Source> sources;
        sources.reserve(runs.size());
        for (const fs::path& run : runs) sources.push_back(source(run));
        const fs::path controller_file = sources.front().scenario.controller;
        const bool endurance = sources.front().scenario.endurance();
        for (const Source& s : sources) {
            if (s.scenario.controller != controller_file || s.scenario.endurance() != endurance)
                throw std::runtime_error(s.log.string() + ": was made on another rig than " + sources.front().log.string() +
                                         "; expected recordings of one rig");
        }
        const antiskid::LayoutFiles layout_files(config);
        const antiskid::can::Layout layout = layout_files.load();
        const auto period_s = static_cast<double>(antiskid::load_controller_config(controller_file).period_s);
        std::vector<Run> recorded;
        std::vector<fs::path> files{controller_file, layout_files.dbc, layout_files.binding};
        recorded.reserve(sources.size());
        for (const Source& s : sources) {
            say("reading " + s.log.string());
            recorded.push_back(run_of(s.scenario, config, currents, read_recording(s.log, layout, period_s)));
            files.insert(files.end(), s.scenario.files.begin(), s.scenario.files.end());
        }
        Identified found;
        try {
            found = identify(recorded);
        } catch (const identification::NotIdentifiable& e) {
            fmt::print(stderr, "rig-lab identify: {}\n", e.what());
            return 1;
        }
        identification::write_config(
            found, {.rig = endurance ? "flywheel_rig.toml" : "landing_gear.toml", .controller = fs::relative(controller_file, config)}, config,
            out / "config");
        say("validation");
        const std::optional<Validated> validation = validated(sources, layout, period_s);
        settings::Json head{
            {"runs", settings::Json::array()}, {"version", ANTISKID_VERSION}, {"config_hash", settings::hash(files)}, {"seed", nullptr}};
        for (const fs::path& run : runs) head["runs"].push_back(run.string());
        print_table(json_file, "{}", identification::to_table(found));
        if (validation && validation->result.braked) {
            const validation::Validation& v = validation->result;
            head["validation"] = {{"run", validation->run},
                                  {"speed_rms_mps", v.all.speed_mps.rms()},
                                  {"wheel_rms_mps", v.all.wheel_rim_mps.rms()},
                                  {"slip_rms", v.all.slip.rms()},
                                  {"past_peak", v.past_peak}};
            print_table(json_file,
                        "{} replayed with these numbers (Fig. 5): aircraft {:.4f} m/s, wheel {:.4f} m/s, slip {:.5f} RMS; {:.0f} % of it beyond the "
                        "friction's peak\n",
                        validation->run, v.all.speed_mps.rms(), v.all.wheel_rim_mps.rms(), v.all.slip.rms(), v.past_peak * 100.0);
        }
        write_json(out / "results.json", json_file, identification::to_json(found, head.dump()));
        if (pictures) draw(found, validation);
        print_table(json_file, "Written to {}: config (for --config), results.json{}\n", out.string(), pictures ? ", pictures" : "");
        return 0;
    }
};

}  // namespace

LabVerb identify_verb(CLI::App& lab) {
    const auto c = std::make_shared<IdentifyCommand>();
    CLI::App* verb =
        lab.add_subcommand("identify", "A rig's valve, brake, wheel and road from its recordings, as configuration that every program loads.");
    settings::existing_path(verb->add_option("RUN", c->runs,
                                             "folders of rig-bridge maneuver or rig-lab maneuver: ramp, step, sweep, slow_braking, heavy "
                                             "(config/scenarios), or bus logs with --scenario"))
        ->required();
    settings::add_json(*verb, c->json_file, "results");
    settings::add_out(*verb, c->out, "folder for the results; its `config` must not exist");
    settings::add_config_directory(*verb, c->config);
    settings::existing_file(verb->add_option("--scenario", c->scenario, "of all runs, instead of the one that summary.json names"));
    settings::existing_path(verb->add_option(
        "--validate", c->validate, "a stop to replay with what was identified (default: the one of the runs that is least beyond the peak)"));
    verb->add_option("--currents", c->currents, "mA: points of the static map, rising (default: those of the configured map)")
        ->delimiter(',')
        ->check(CLI::Range(0.0, 1000.0));
    settings::add_no_pictures(*verb, c->pictures);
    verb->footer(
        "Leaves in --out: config/ (a copy of --config with the identified numbers), results.json, and pictures: static_map.png,\n"
        "valve_RUN.png, wheel.png, friction_SURFACE.png, friction_curves.png (Fig. 3), validation.png (Fig. 5).\n"
        "Examples:\n"
        "  for s in ramp step sweep slow_braking heavy; do rig-lab maneuver config/scenarios/$s.toml --out runs/$s; done\n"
        "  rig-lab identify runs/ramp runs/step runs/sweep runs/slow_braking runs/heavy --out out/identify\n"
        "  rig-lab stop --config out/identify/config\n"
        "Exit status: 0 identified; 1 the recordings do not show it, with what is missing; 2 mistake in command line, configuration or files.");
    return {verb, [c] { return c->run(); }};
}

}  // namespace plant_sim::lab
