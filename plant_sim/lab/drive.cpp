#include <memory>

#include "firmware/host/settings/config_directory.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/study/drive.hpp"
#include "rig_bridge/rig/load_rig.hpp"

namespace plant_sim::lab {

namespace {

struct DriveCommand {
    rig::ManeuverChoice choice;
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path input;
    std::string csv;

    int run() const {
        const rig::LoadedRig rig = rig::load_rig(config, choice);
        settings::deliver(csv, study::drive(rig.rig, study::read_profile(input)));
        return 0;
    }
};

}  // namespace

LabVerb drive_verb(CLI::App& lab) {
    const auto drive = std::make_shared<DriveCommand>();
    CLI::App* verb = lab.add_subcommand("drive", "Open loop: the plant alone under a pressure or current profile.");
    verb->add_option("--maneuver", drive->choice.maneuver, "mass and speed")->capture_default_str();
    auto* const surface = verb->add_option("--surface", drive->choice.surface, "runway")->capture_default_str();
    settings::existing_file(
        verb->add_option("--runway", drive->choice.runway, "surfaces over distance from the profile's start: a file as config/runways has them"))
        ->excludes(surface);
    settings::existing_file(verb->add_option("--input", drive->input, "CSV: time_s,pressure_Pa or time_s,current_mA, linear between rows"))
        ->required();
    settings::result_file(verb->add_option("--csv", drive->csv, "the motion; - for standard output"))->required();
    verb->add_option("--mass", drive->choice.mass_kg, "kg, instead of the maneuver's");
    verb->add_option("--speed", drive->choice.speed_mps, "m/s, instead of the maneuver's");
    verb->add_option("--mu-b", drive->choice.friction, "mean brake friction instead of a new brake's");
    settings::add_config_directory(*verb, drive->config);
    verb->footer("Example:\n  rig-lab drive --maneuver light --surface wet_asphalt --input pressure.csv --csv motion.csv");
    return {verb, [drive] { return drive->run(); }};
}

}  // namespace plant_sim::lab
