#include <fmt/core.h>

#include <map>
#include <memory>

#include "rig_bridge/replay/controller_replay.hpp"
#include "rig_bridge/replay/replay_verbs.hpp"

namespace rig {

namespace {

struct ControllerCommand {
    std::string log;
    std::string interface;
    ReplayClock clock = ReplayClock::automatic;
    antiskid::rt::Options setup;
    std::string json;

    int run() const {
        const antiskid::rt::Setup loaded = configured([&] { return antiskid::rt::load_setup(setup); });
        LogWarnings warnings = warnings_of(log);
        LogOptions options;
        if (!interface.empty()) options.interface = interface;
        const ControllerReplayReport report = replay_controller(log, options, loaded, clock, warnings);
        if (json != "-") fmt::print("{}", to_text(report, loaded.layout));
        deliver(json, to_json(report, loaded.layout));
        return report.same() ? 0 : 1;
    }
};

}  // namespace

ReplayVerb controller_verb(CLI::App& app) {
    const auto command = std::make_shared<ControllerCommand>();
    CLI::App* verb = app.add_subcommand(
        "controller",
        "Recorded sensor frames through the real controller; compares what it sends with what was recorded.");
    verb->add_option("LOG", command->log, "bus log of one controller session, candump format, plain or gzip")
        ->required();
    verb->add_option("--controller", command->setup.config, "controller configuration of the recorded run")
        ->capture_default_str();
    verb->add_option("--dbc", command->setup.dbc, "bus layout")->capture_default_str();
    verb->add_option("--binding", command->setup.binding, "binding of the layout")->capture_default_str();
    verb->add_option("--interface", command->interface,
                     "lines of this interface (default: the first in the log)");
    verb->add_option("--clock", command->clock,
                     "auto: lockstep where SYNC comes before the first valve command, else timer")
        ->transform(CLI::CheckedTransformer(std::map<std::string, ReplayClock>{
            {"auto", ReplayClock::automatic}, {"sync", ReplayClock::sync}, {"timer", ReplayClock::timer}}))
        ->default_str("auto");
    verb->add_option("--json", command->json, "report as JSON; - for standard output");
    verb->footer(
        "Examples:\n"
        "  rig-replay controller out/landing/bus.log\n"
        "  rig-replay controller bus.log.gz --controller config/controller_endurance.toml --json -\n"
        "Exit status: 0 no frame differs; 1 some do, or the log cannot be read; 2 mistake in command line or "
        "configuration.");
    return {verb, [command] { return command->run(); }};
}

}  // namespace rig
