#include <fmt/core.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "firmware/host/layout_files.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/stop_signals.hpp"
#include "plant_sim/lab/panel_stops.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "rig_bridge/bridge/panel_recordings.hpp"
#include "rig_bridge/panel/server.hpp"

namespace plant_sim::lab {

namespace {

namespace panel = rig::panel;

struct PanelCommand {
    std::filesystem::path folder;
    std::string at = panel::kDefaultAddress;
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path dbc, binding;

    int run() const {
        antiskid::host::StopSignals stops;
        PanelStops tried(config);
        panel::ServerOptions options{
            .address = panel::parse_address(at),
            .about = {.title = "rig-lab" + (folder.empty() ? "" : ": " + std::filesystem::weakly_canonical(folder).filename().string()),
                      .views = {},
                      .what_if = tried.fields()}};
        std::optional<rig::bridge::PanelRecordings> recorded;
        if (!folder.empty()) {
            recorded.emplace(folder, config, antiskid::LayoutFiles(config, dbc, binding).load());
            rig::bridge::add_recorded(options, *recorded);
            if (recorded->with_ledger())
                options.changes["note"] = [&recorded](const panel::Query& q) {
                    return recorded->note(q.text("campaign"), q.integer("number"), q.integer("attempt"), q.text("who"), q.text("text"));
                };
        }
        options.about.views.emplace_back("what_if");
        options.reads["stop"] = [&tried](const panel::Query& q) { return tried.stop(q); };
        const panel::Server server(std::move(options));
        fmt::print("{}\nCtrl-C ends it\n", server.greeting());
        (void)std::fflush(stdout);
        constexpr std::chrono::milliseconds kLook{50};
        while (stops.count() == 0) std::this_thread::sleep_for(kLook);
        return 0;
    }
};

}  // namespace

LabVerb panel_verb(CLI::App& lab) {
    const auto command = std::make_shared<PanelCommand>();
    CLI::App* verb = lab.add_subcommand("panel", "Recorded maneuvers over each other, and stops that are tried by sliders, in a browser.");
    settings::existing_directory(
        verb->add_option("FOLDER", command->folder, "of a campaign, or with folders of maneuvers; without one only what-if"));
    verb->add_option("--panel", command->at, "where it is served; port 0: any free one")->type_name("ADDRESS:PORT")->capture_default_str();
    settings::add_config_directory(*verb, command->config);
    settings::add_layout_files(*verb, command->dbc, command->binding);
    verb->footer(
        "Examples:\n"
        "  rig-lab panel\n"
        "  rig-lab panel runs/brake7\n"
        "  rig-lab maneuver config/scenarios/heavy.toml --seed 1 --out landings/a\n"
        "  rig-lab maneuver config/scenarios/heavy.toml --seed 2 --out landings/b\n"
        "  rig-lab panel landings\n"
        "Runs until Ctrl-C. Notes need the token of the link that it prints.");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim::lab
