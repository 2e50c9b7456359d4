/// Runs a campaign of empty maneuvers as fast as it can and says `finished N` after each that is entered, for a test to kill.
/// ledger_writer LEDGER PLANNED

#include <unistd.h>

#include <cstdio>
#include <exception>
#include <string>

#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/record/summary_file.hpp"

namespace {

void say(const std::string& text) {
    const std::string line = text + "\n";
    if (write(STDOUT_FILENO, line.data(), line.size()) < 0) _exit(3);
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc != 3) return 2;
    rig::record::Ledger ledger(argv[1]);
    const rig::record::Campaign campaign{
        .name = "killed", .scenario = "endurance", .seed = 1, .planned = std::stoll(argv[2]), .config_hash = "abc", .version = "0", .created = "now"};
    const rig::record::Resumed resumed = ledger.open_campaign(campaign, rig::record::IfChanged::reject);
    for (const std::int64_t number : resumed.adopted) say("adopted " + std::to_string(number));
    for (const std::int64_t number : resumed.unfinished) say("unfinished " + std::to_string(number));
    while (const auto number = ledger.next_number()) {
        const rig::record::Attempt attempt = ledger.begin(*number, "now");
        rig::record::Summary summary;
        summary.campaign = campaign.name;
        summary.number = *number;
        summary.scenario = campaign.scenario;
        summary.outcome = "finished";
        summary.started = "now";
        summary.figures.energy_brake_J = 1000.0 * static_cast<double>(*number);
        summary.cumulative_energy_J = ledger.cumulative_energy_J() + summary.figures.energy_brake_J;
        rig::record::write_summary(attempt.folder / "summary.json", summary);
        ledger.finish(summary);
        say("finished " + std::to_string(*number));
    }
    say("complete");
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
