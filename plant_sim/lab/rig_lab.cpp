/// rig-lab: studies in process, faster than real time. See --help.

#include <fmt/core.h>

#include <array>
#include <cstdio>
#include <exception>

#include "plant_sim/lab/verbs.hpp"

namespace {

int run(int argc, char** argv) {
    CLI::App app{"rig-lab: studies of controller and plant in process, without a bus.", "rig-lab"};
    app.set_version_flag("--version", ANTISKID_VERSION);
    app.require_subcommand(1);
    const std::array verbs{
        plant_sim::stop_verb(app),       //
        plant_sim::drive_verb(app),      //
        plant_sim::compare_verb(app),    //
        plant_sim::endurance_verb(app),  //
        plant_sim::soak_verb(app),       //
        plant_sim::sweep_verb(app),      //
        plant_sim::regulate_verb(app),   //
        plant_sim::trade_verb(app),      //
        plant_sim::margins_verb(app),    //
        plant_sim::tune_verb(app),       //
        plant_sim::maneuver_verb(app),   //
        plant_sim::plant_verb(app),      //
        plant_sim::identify_verb(app),   //
        plant_sim::wear_verb(app),       //
        plant_sim::faults_verb(app),     //
        plant_sim::robust_verb(app),     //
        plant_sim::surfaces_verb(app),   //
        plant_sim::report_verb(app),     //
    };
    if (const auto status = settings::parse(app, argc, argv)) return *status;
    return plant_sim::run_parsed(verbs);
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
