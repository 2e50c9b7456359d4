/// rig-replay: plays, replays, rebuilds, imports and exports recordings of the bus. See --help.

#include <fmt/core.h>

#include <array>
#include <cstdio>
#include <exception>

#include "rig_bridge/replay/replay_verbs.hpp"

rig::replay::LogWarnings rig::replay::warnings_of(const std::string& file) {
    return {file, [](const std::string& text) { fmt::print(stderr, "rig-replay: warning: {}\n", text); }};
}

namespace {

int run(int argc, char** argv) {
    CLI::App app{"rig-replay: bus logs played, replayed through the controller, rebuilt, imported and exported.", "rig-replay"};
    app.set_version_flag("--version", ANTISKID_VERSION);
    app.require_subcommand(1);
    const std::array verbs{rig::replay::bus_verb(app), rig::replay::campaign_verb(app), rig::replay::controller_verb(app),
                           rig::replay::export_verb(app), rig::replay::import_verb(app)};
    app.footer("Each has --help with examples.");
    if (const auto status = settings::parse(app, argc, argv)) return *status;
    for (const rig::replay::ReplayVerb& verb : verbs) {
        if (verb.app->parsed()) return verb.run();
    }
    return 2;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const rig::replay::UsageError& e) {
        std::fprintf(stderr, "rig-replay: %s\n", e.what());
        return 2;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "rig-replay: %s\n", e.what());
        return 1;
    }
}
