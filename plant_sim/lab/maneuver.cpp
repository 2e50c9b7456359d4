#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/input_file.hpp"
#include "plant_sim/endurance/endurance_setup.hpp"
#include "plant_sim/endurance/frame_log.hpp"
#include "plant_sim/endurance/test_cell.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "rig_bridge/record/summary_file.hpp"

namespace plant_sim::lab {

namespace {

struct ManeuverCommand {
    std::filesystem::path scenario;
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path out;
    std::string json_file;  ///< "-": standard output
    std::uint64_t seed = 1;

    [[nodiscard]] int run() const {
        endurance::EnduranceSetup setup = endurance::load_setup(scenario, config);
        setup.machinery.brake.reset();
        const auto folder = out.empty() ? std::filesystem::path("out") / setup.scenario.name : out;
        std::filesystem::create_directories(folder);
        for (const char* const file : {"bus.log", "summary.json"}) {
            if (std::filesystem::exists(folder / file)) {
                throw std::runtime_error(folder.string() + " has a " + file + " already; a maneuver gets a folder of its own (--out)");
            }
        }
        endurance::TestCell cell(setup.scenario, setup.controller, setup.layout, setup.machinery, seed);
        const auto period_us = std::llround(static_cast<double>(setup.controller.period_s) * 1e6);
        endurance::FrameLog log(setup.layout, antiskid::control::Time(period_us * 1000), folder / "bus.log");
        const rig::Plan plan = rig::plan(setup.scenario, seed, 1);
        const endurance::Outcome outcome = cell.run(plan, [&log](const endurance::Period& period) { log.add(period); });
        log.finish();
        rig::record::Summary summary;
        summary.number = 1;
        summary.scenario = setup.scenario.name;
        summary.started = "1970-01-01T00:00:00Z";  // the rig's own time
        summary.frames = log.frames();
        summary.seed = seed;
        summary.version = ANTISKID_VERSION;
        summary.config_hash = setup.config_hash;
        summary = endurance::summary_of(summary, outcome, acceptance(setup.scenario, plan));
        rig::record::write_summary(folder / "summary.json", summary);
        settings::deliver(json_file, settings::read_file(folder / "summary.json"));
        print_table(json_file, "{}Written to {}: bus.log, summary.json\n", rig::record::summary_table(summary), folder.string());
        return outcome.phase == rig::Phase::finished ? 0 : 1;
    }
};

}  // namespace

LabVerb maneuver_verb(CLI::App& lab) {
    const auto c = std::make_shared<ManeuverCommand>();
    CLI::App* verb = lab.add_subcommand(
        "maneuver", "A scenario on the virtual rig in process, recorded as rig-bridge maneuver records it. The brake has its nominal friction.");
    settings::existing_file(verb->add_option("SCENARIO", c->scenario, "a file of config/scenarios"))->required();
    settings::add_config_directory(*verb, c->config);
    settings::add_seed(*verb, c->seed);
    settings::add_json(*verb, c->json_file, "summary");
    settings::add_out(*verb, c->out, "folder for bus.log and summary.json (default: out/SCENARIO)");
    verb->footer(
        "Example:\n  rig-lab maneuver config/scenarios/ramp.toml --out runs/ramp\n"
        "Exit status: 0 finished; 1 aborted; 2 mistake in command line or configuration.");
    return {verb, [c] { return c->run(); }};
}

}  // namespace plant_sim::lab
