#include <fmt/core.h>

#include <memory>

#include "rig_bridge/replay/controller_replay.hpp"
#include "rig_bridge/replay/replay_verbs.hpp"

namespace rig::replay {

namespace {

struct ControllerCommand {
    std::string log;
    std::string interface;
    ReplayClock clock = ReplayClock::automatic;
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path controller, dbc, binding;
    std::string json;

    int run() const {
        antiskid::controller::Options setup;
        setup.controller = controller.empty() ? config / "controller.toml" : controller;
        setup.layout = antiskid::LayoutFiles(config, dbc, binding);
        const antiskid::controller::ControllerSetup loaded = configured([&] { return antiskid::controller::load_setup(setup); });
        LogWarnings warnings = warnings_of(log);
        LogOptions options;
        if (!interface.empty()) options.interface = interface;
        const ControllerReplayReport report = replay_controller(log, options, loaded, clock, warnings);
        if (json != "-") fmt::print("{}", to_text(report, loaded.layout));
        settings::deliver(json, to_json(report, loaded.layout));
        return report.same() ? 0 : 1;
    }
};

}  // namespace

ReplayVerb controller_verb(CLI::App& app) {
    const auto command = std::make_shared<ControllerCommand>();
    CLI::App* verb =
        app.add_subcommand("controller", "Recorded sensor frames through the real controller; compares what it sends with what was recorded.");
    settings::existing_file(
        verb->add_option("LOG", command->log, "bus log of one controller session: candump, Vector ASC or BLF, PEAK TRC, plain or gzip"))
        ->required();
    settings::add_config_directory(*verb, command->config);
    settings::existing_file(verb->add_option("--controller", command->controller, "of the recorded run (default: CONFIG/controller.toml)"));
    settings::add_layout_files(*verb, command->dbc, command->binding);
    verb->add_option("--interface", command->interface, "lines of this interface (default: the first in the log)");
    settings::add_choice(*verb, "--clock", command->clock,
                         {{"auto", ReplayClock::automatic}, {"sync", ReplayClock::sync}, {"timer", ReplayClock::timer}},
                         "auto: lockstep where SYNC comes before the first valve command, else timer");
    settings::add_json(*verb, command->json, "report");
    verb->footer(
        "Examples:\n"
        "  rig-replay controller out/landing/bus.log\n"
        "  rig-replay controller bus.log.gz --controller config/controller_endurance.toml --json -\n"
        "Exit status: 0 no frame differs; 1 some do, or the log cannot be read; 2 mistake in command line or configuration.");
    return {verb, [command] { return command->run(); }};
}

}  // namespace rig::replay
