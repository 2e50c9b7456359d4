/// rig-lab: studies in process, faster than real time. See --help.

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <array>
#include <cstdio>
#include <exception>

#include "config/reader/atomic_file.hpp"
#include "plant_sim/lab_verbs.hpp"

void plant_sim::deliver(const std::string& where, std::string_view text) {
    if (where == "-")
        fmt::print("{}", text);
    else
        settings::write_file(where, text);
}

namespace {

int run(int argc, char** argv) {
    CLI::App app{"rig-lab: studies of controller and plant in process, without a bus.", "rig-lab"};
    app.set_version_flag("--version", ANTISKID_VERSION);
    app.require_subcommand(1);
    const std::array verbs{plant_sim::stop_verb(app), plant_sim::drive_verb(app),
                           plant_sim::compare_verb(app), plant_sim::wear_verb(app),
                           plant_sim::endurance_verb(app)};
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        return app.exit(e) == 0 ? 0 : 2;
    }
    for (const plant_sim::LabVerb& verb : verbs) {
        if (verb.app->parsed()) return verb.run();
    }
    return 2;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "rig-lab: %s\n", e.what());
        return 2;
    }
}
