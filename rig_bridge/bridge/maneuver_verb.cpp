#include <fmt/chrono.h>
#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <optional>

#include "firmware/host/settings/atomic_file.hpp"
#include "rig_bridge/bridge/bridge_panel.hpp"
#include "rig_bridge/bridge/bridge_setup.hpp"
#include "rig_bridge/bridge/realtime.hpp"
#include "rig_bridge/bridge/rig_hold.hpp"
#include "rig_bridge/bridge/session.hpp"
#include "rig_bridge/bridge/start_checks.hpp"
#include "rig_bridge/bridge/verbs.hpp"
#include "rig_bridge/pictures/stop_picture.hpp"
#include "rig_bridge/record/summary_file.hpp"

namespace rig::bridge {

namespace {

constexpr double kAnyTemperature_C = 1e4;

std::filesystem::path folder(const BridgeSetup& setup) {
    if (setup.options.out.empty()) {
        const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
        return std::filesystem::path("out") / fmt::format("{}-{:%Y%m%dT%H%M%SZ}", setup.scenario.name, fmt::gmtime(now));
    }
    for (const char* const file : {"bus.log", "modbus.csv", "summary.json"}) {
        if (std::filesystem::exists(setup.options.out / file))
            throw UsageError("--out " + setup.options.out.string() + ": has a " + file + " already; a maneuver gets a folder of its own");
    }
    return setup.options.out;
}

void draw(const std::filesystem::path& place, const std::filesystem::path& picture, const std::string& title, const Trace& trace) {
    settings::write_file(place / "trajectory.csv", trace.csv());
    pictures::draw_stop(trace.rows(), picture, title, trace.brake_on_s());
}

}  // namespace

int run_maneuver(const ManeuverCommand& command) {
    const BridgeSetup setup = load_setup(command.rig);
    const std::filesystem::path place = folder(setup);
    const RigHold hold(hold_places(setup), holder_text("maneuver", place));
    check_start(setup, place);
    antiskid::host::StopSignals stops;
    Terminal terminal(STDERR_FILENO, wanted(setup.options.view));
    rig::Plan planned = plan(setup.scenario, setup.options.seed, 1);
    if (!command.cool_down) planned.cool_to_C = kAnyTemperature_C;
    const ManeuverRequest request{
        .plan = planned, .campaign = {}, .number = 1, .folder = place, .specimen = command.rig.specimen, .taken_J = 0.0, .view = std::nullopt};
    std::optional<BridgePanel> panel;
    if (!setup.options.panel.empty()) panel.emplace(setup, std::filesystem::path(), stops, terminal);
    enter_realtime(setup.options.priority, terminal);
    Session session(setup, stops, terminal, panel ? &*panel : nullptr);
    try {
        const Ran ran = session.run(request);
        session.meanwhile([&] {
            record::write_summary(request.folder / "summary.json", ran.summary);
            if (!command.picture.empty() && !ran.trace.empty()) draw(request.folder, command.picture, setup.scenario.title, ran.trace);
        });
        fmt::print("{}Written to {}: bus.log, modbus.csv, summary.json\n", record::summary_table(ran.summary), request.folder.string());
        if (ran.summary.outcome != name(rig::Phase::finished))
            session.tell_of_abort(ran, request.folder, "the maneuver was aborted; the program ends");
        if (!ran.record_error.empty()) {
            terminal.say("rig-bridge: the record is not whole: " + ran.record_error);
            return 1;
        }
        if (!ran.outside.empty()) terminal.say("rig-bridge: out of tolerance: " + ran.outside);
        const int interrupted = stops.count() > 0 ? 128 + stops.number() : 0;
        if (ran.summary.outcome == name(rig::Phase::finished)) return interrupted;
        if (interrupted == 0)
            terminal.say("rig-bridge: the maneuver was aborted: " + ran.summary.outcome + (ran.note.empty() ? "" : "; " + ran.note));
        session.watch_rim(request.plan.standstill_mps);
        return interrupted != 0 ? interrupted : 1;
    } catch (const EndAtOnce&) {
        terminal.say("rig-bridge: ended at once; the PLC's watchdog and the controller's time-outs make the rig safe");
        return 128 + stops.number();
    }
}

}  // namespace rig::bridge
