#include <sys/stat.h>

#include <chrono>

#include "firmware/host/settings/json.hpp"
#include "rig_bridge/bridge/abort_hook.hpp"
#include "rig_bridge/bridge/hold.hpp"
#include "rig_bridge/bridge/watch_view.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

using can_test::TempDir;
using rig::Phase;
using rig::bridge::BridgeActivity;
using rig::bridge::StripChart;
using rig::bridge::WatchedCampaign;

namespace {

std::filesystem::path script(const TempDir& dir, const std::string& text) {
    const std::filesystem::path file = dir.write("hook.sh", "#!/bin/sh\n" + text + "\n");
    REQUIRE(chmod(file.c_str(), 0755) == 0);
    return file;
}

WatchedCampaign watched_braking() {
    WatchedCampaign w;
    w.campaign = "brake7";
    w.scenario = "light";
    w.finished = 6;
    w.planned = 500;
    w.left_s = 3 * 3600.0 + 12 * 60.0;
    w.outcomes = {"0005 finished", "0006 controller_silent", "0006.2 finished"};
    w.bridge = {.silent_s = 0.01, .with_ledger = true, .held = true, .running = 7};
    w.bus_up = true;
    w.number = 7;
    w.phase = Phase::braking;
    w.phase_s = 2.25;
    w.phase_began = true;
    w.rim_mps = 30.0;
    w.wheel_mps = 24.0;
    w.slip = 0.2;
    w.slip_reference = 0.24;
    w.pressure_Pa = 9.25e6;
    w.load_N = 43210.0;
    w.current_mA = 6.5;
    w.controller = "braking";
    w.tells_road = true;
    w.road = antiskid::control::RoadEstimate{.peak_slip = 0.12F, .grip_N = 12300.0F, .confidence = 0.8F};
    return w;
}

}  // namespace

TEST_CASE("A hold says who, since when and why, and whoever made it", "[BRG-471]") {
    const TempDir dir;
    const auto place = dir.write("x", "").parent_path();
    CHECK_FALSE(rig::bridge::read_hold(place).has_value());
    CHECK_FALSE(rig::bridge::remove_hold(place));
    rig::bridge::write_hold(place, {.who = "A. \"R\"", .since = "2026-11-25T10:00:00Z", .why = "tyre change"});
    CHECK(rig::bridge::to_text(*rig::bridge::read_hold(place)) == "held by A. \"R\" since 2026-11-25T10:00:00Z: tyre change");
    for (const char* const spoilt : {"", "{", "[]", "{\"who\": 3}"}) {
        static_cast<void>(dir.write("campaign.hold", spoilt));
        INFO(spoilt);
        REQUIRE(rig::bridge::read_hold(place).has_value());
        CHECK_THAT(rig::bridge::to_text(*rig::bridge::read_hold(place)), ContainsSubstring("held by somebody"));
    }
    CHECK(rig::bridge::remove_hold(place));
    CHECK_FALSE(rig::bridge::read_hold(place).has_value());
}

TEST_CASE("A campaign that is held waits for its start until a maneuver was begun, also where nobody can read who holds it", "[BRG-471]") {
    using rig::bridge::HoldStatus;
    const TempDir dir;
    const auto place = dir.write("x", "").parent_path();
    CHECK(rig::bridge::hold_status(place, false) == HoldStatus::runs);
    static_cast<void>(dir.write("campaign.hold", "spoilt"));
    CHECK(rig::bridge::hold_status(place, false) == HoldStatus::waits);
    CHECK(rig::bridge::hold_status(place, true) == HoldStatus::held);
    CHECK(rig::bridge::remove_hold(place));
    CHECK(rig::bridge::hold_status(place, true) == HoldStatus::runs);
}

TEST_CASE("The program for aborts is told what happened, line by line and without a shell", "[BRG-471]") {
    const TempDir dir;
    const auto out = dir.write("told", "");
    const auto hook = script(dir, "env | grep ^RIG_ | sort > " + out.string() + "; cat >> " + out.string());
    const auto environment = rig::bridge::environment_of({.outcome = "$(touch x); retry 1 of 2",
                                                          .cause = "guard_open",
                                                          .next_step = "first\nRIG_FORGED=1",
                                                          .campaign = "a b",
                                                          .maneuver = 31,
                                                          .folder = "/runs/a b/0031"});
    CHECK(rig::bridge::run_hook(hook, environment).empty());
    CHECK(can_test::contents(out) ==
          "RIG_CAMPAIGN=a b\nRIG_CAUSE=guard_open\nRIG_FOLDER=/runs/a b/0031\n"
          "RIG_MANEUVER=31\nRIG_NEXT_STEP=first RIG_FORGED=1\n"
          "RIG_OUTCOME=$(touch x); retry 1 of 2\n");
}

TEST_CASE("A program for aborts that fails or hangs is named, and holds nobody", "[BRG-471]") {
    const TempDir dir;
    using std::chrono::milliseconds;
    CHECK_THAT(rig::bridge::run_hook(script(dir, "exit 3"), {}), ContainsSubstring("exit status 3"));
    CHECK_THAT(rig::bridge::run_hook(script(dir, "kill -9 $$"), {}), ContainsSubstring("ended by signal 9"));
    // Its children die with it.
    const auto out = dir.write("late", "");
    CHECK_THAT(rig::bridge::run_hook(script(dir, "(sleep 1; echo late > " + out.string() + ") & sleep 60"), {}, milliseconds(100)),
               ContainsSubstring("had not ended after 0.1 s and was killed"));
    CHECK(rig::bridge::run_hook(script(dir, "sleep 1.2"), {}).empty());
    CHECK(can_test::contents(out).empty());
    CHECK_THAT(rig::bridge::run_hook(dir.write("no_program", "text"), {}), ContainsSubstring("Permission denied"));
    CHECK_THROWS_WITH(rig::bridge::check_hook(dir.write("no_program", "text")), ContainsSubstring("chmod +x"));
    CHECK_THROWS_WITH(rig::bridge::check_hook("/nowhere"), ContainsSubstring("--on-abort /nowhere"));
    CHECK_THROWS_WITH(rig::bridge::check_hook("/tmp"), ContainsSubstring("expected a program"));
    CHECK_NOTHROW(rig::bridge::check_hook(script(dir, "")));
}

TEST_CASE("Who runs the campaign is told from bus and ledger", "[BRG-420]") {
    const auto says = [](std::optional<double> silent_s, bool with_ledger, bool held, std::int64_t running) {
        return to_text(BridgeActivity{silent_s, with_ledger, held, running});
    };
    CHECK(says(0.02, true, true, 7) == "at work");
    CHECK(says(0.02, false, false, 0) == "at work");
    CHECK(says(0.02, true, false, 7) == "at work on this bus, but not with this ledger");
    CHECK(says(4.0, true, true, 7) == "silent for 4 s on the bus, though it holds the ledger");
    CHECK(says(4.0, true, false, 7) == "silent for 4 s, DEAD: maneuver 7 was left; the same campaign command goes on");
    CHECK(says({}, true, false, 0) == "not heard: nobody runs this campaign");
    CHECK(says({}, false, false, 0) == "not heard");
}

TEST_CASE("The watch's screen has phase, figures, road and outcomes in 80 columns", "[BRG-420]") {
    StripChart chart;
    WatchedCampaign w = watched_braking();
    const auto lines = watch_screen(w, chart);
    REQUIRE(lines.size() == 8 + 13);
    CHECK(lines[0] == "brake7: maneuver 7, 6 of 500 finished, 3 h 12 min left");
    CHECK(lines[1] == "bridge at work");
    CHECK(lines[2] == "braking        2.2 s in this phase");
    CHECK(lines[3] == "rim  30.00 m/s   wheel  24.00 m/s   slip  0.200   reference 0.240");
    CHECK(lines[4] == "pressure  9.25 MPa   load  43.21 kN   current   6.50 mA");
    CHECK(lines[5] == "controller braking   faults: none");
    CHECK(lines[6] == "road: grip 12.30 kN at slip 0.120, confidence 0.80");
    CHECK(lines[7] == "last: 0005 finished, 0006 controller_silent, 0006.2 finished");
    w.phase_began = false;
    w.road.reset();
    w.hold = "held by A. Rossi";
    w.specimen = "disc D7";
    w.senders = "two controllers talk on the bus: two senders of 0x180, at counters 3 and 9";
    w.bus_up = false;
    w.bus_error = "vcan0: Network is down";
    w.ledger_error = "locked";
    w.faults.assign(20, "pressure_off_command");
    const auto more = watch_screen(w, chart);
    CHECK(more[2] == "HOLD: held by A. Rossi");
    CHECK(more[3] == "disc D7");
    CHECK(more[4] == "braking        at least 2.2 s in this phase");
    CHECK(more[8] == "road: not heard");
    CHECK(more[10] == w.senders);
    CHECK(more[11] == "BUS DOWN: vcan0: Network is down");
    CHECK(more[12] == "ledger: locked");
    for (const std::string& line : more) CHECK(line.size() <= 80);
    CHECK_THAT(watch_line(w), ContainsSubstring("HOLD: held by A. Rossi") && ContainsSubstring(w.senders) && ContainsSubstring("BUS DOWN"));
    CHECK(watch_screen(WatchedCampaign{}, chart)[0] == ": no maneuver");
}

TEST_CASE("The watch's JSON is one line with null for what is not known", "[BRG-420]") {
    WatchedCampaign w = watched_braking();
    const std::string text = watch_json(w);
    CHECK(text.find('\n') == std::string::npos);
    auto json = settings::parse_json(text);
    CHECK(json["phase"] == "braking");
    CHECK(json["bridge_heard"] == true);
    CHECK(json["road"]["grip_N"] == 12300.0);
    CHECK(json["left_s"] == 11520.0);
    CHECK(json["senders"].get<std::string>().empty());
    w.rim_mps = std::nan("");
    w.phase.reset();
    w.road.reset();
    w.left_s.reset();
    json = settings::parse_json(watch_json(w));
    for (const char* const key : {"rim_mps", "phase", "road", "left_s"}) CHECK(json[key].is_null());
}

TEST_CASE("The strip chart keeps ten seconds, newest at the right", "[BRG-420]") {
    StripChart chart;
    for (const std::string& line : chart.lines()) CHECK(line.size() <= StripChart::kWidth);
    const auto at = [&](double time_s, double rim_mps) {
        chart.add({.time_s = time_s, .rim_mps = rim_mps, .wheel_mps = 0.0, .slip = -0.1, .slip_reference = 0.24, .pressure_Pa = 3e6});
    };
    for (int i = 0; i <= 200; ++i) at(0.1 * i, 40.0 - 2.0 * 0.1 * i);
    const auto lines = chart.lines();
    REQUIRE(lines.size() == 13);
    // From 20 m/s ten seconds ago to none now, on a scale of 20 m/s.
    CHECK(lines[0].starts_with("speed, m/s     20 |*"));
    CHECK(lines[3].back() == '*');
    CHECK(std::count(lines[0].begin(), lines[0].end(), '*') + std::count(lines[1].begin(), lines[1].end(), '*') +
              std::count(lines[2].begin(), lines[2].end(), '*') + std::count(lines[3].begin(), lines[3].end(), '*') ==
          StripChart::kColumns);
    CHECK(lines[4].starts_with("slip          0.5 |"));
    CHECK(lines[8].starts_with("p, MPa          5 |"));
    CHECK_THAT(lines[12], ContainsSubstring("|-10 s"));
    CHECK(lines[12].ends_with("now"));
    for (const std::string& line : lines) CHECK(line.size() <= StripChart::kWidth);
    // Another clock: what was seen is not before it.
    at(1.0, 5.0);
    const auto anew = chart.lines();
    CHECK(std::count(anew[0].begin(), anew[0].end(), '*') == 1);
    CHECK(anew[0].back() == '*');
    at(1.5, std::nan(""));
    CHECK(chart.lines().size() == 13);
}
