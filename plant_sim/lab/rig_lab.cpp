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
        plant_sim::lab::stop_verb(app),       //
        plant_sim::lab::drive_verb(app),      //
        plant_sim::lab::compare_verb(app),    //
        plant_sim::lab::endurance_verb(app),  //
        plant_sim::lab::simulate_verb(app),   //
        plant_sim::lab::soak_verb(app),       //
        plant_sim::lab::sweep_verb(app),      //
        plant_sim::lab::regulate_verb(app),   //
        plant_sim::lab::trade_verb(app),      //
        plant_sim::lab::margins_verb(app),    //
        plant_sim::lab::tune_verb(app),       //
        plant_sim::lab::maneuver_verb(app),   //
        plant_sim::lab::plant_verb(app),      //
        plant_sim::lab::identify_verb(app),   //
        plant_sim::lab::wear_verb(app),       //
        plant_sim::lab::faults_verb(app),     //
        plant_sim::lab::robust_verb(app),     //
        plant_sim::lab::surfaces_verb(app),   //
        plant_sim::lab::report_verb(app),     //
        plant_sim::lab::panel_verb(app),      //
    };
    if (const auto status = settings::parse(app, argc, argv)) return *status;
    return plant_sim::lab::run_parsed(verbs);
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
