#include "rig_bridge/bridge/options.hpp"

#include <vector>

#include "tests/catch.hpp"

namespace {

std::variant<rig::bridge::BridgeCommand, int> parse(std::vector<const char*> words) {
    words.insert(words.begin(), "rig-bridge");
    return rig::bridge::parse_bridge_command(static_cast<int>(words.size()), words.data());
}

template <typename T>
T command(std::vector<const char*> words) {
    return std::get<T>(std::get<rig::bridge::BridgeCommand>(parse(std::move(words))));
}

}  // namespace

TEST_CASE("The command line says which rig, which maneuver and where to", "[BRG-430]") {
    const auto one = command<rig::bridge::ManeuverCommand>({"maneuver", "config/scenarios/heavy.toml", "--can", "vcan0", "--plc", "127.0.0.1:1502"});
    CHECK(one.rig.scenario == "config/scenarios/heavy.toml");
    CHECK(one.rig.interface == "vcan0");
    CHECK(one.rig.plc == "127.0.0.1:1502");
    CHECK(one.rig.seed == 1);
    CHECK(one.rig.reset);
    CHECK(one.cool_down);
    CHECK_FALSE(one.rig.leave_turning);
    CHECK_FALSE(one.rig.lockstep);
    const auto lockstep = command<rig::bridge::ManeuverCommand>(
        {"maneuver", "config/scenarios/heavy.toml", "--can", "vcan0", "--plc", "127.0.0.1:1502", "--clock", "sync", "--answer-timeout", "3000"});
    CHECK(lockstep.rig.lockstep);
    CHECK(lockstep.rig.answer_timeout_ms == 3000);
    CHECK(std::get<int>(parse({"maneuver", "config/scenarios/heavy.toml", "--can", "vcan0", "--plc", "127.0.0.1:1502", "--clock", "sensors"})) == 2);
    CHECK(command<rig::bridge::ManeuverCommand>(
              {"maneuver", "config/scenarios/heavy.toml", "--can", "vcan0", "--plc", "127.0.0.1:1502", "--leave-turning"})
              .rig.leave_turning);
    const auto many =
        command<rig::bridge::CampaignCommand>({"campaign", "config/scenarios/endurance.toml", "--can", "can0", "--plc-rtu", "/dev/ttyUSB0", "--out",
                                               "runs/1", "--maneuvers", "500", "--retry", "2", "--min-friction", "0.15", "--no-reset"});
    CHECK(many.rig.plc == "/dev/ttyUSB0");
    CHECK(many.rules.maneuvers == 500);
    CHECK(many.rules.retries == 2);
    CHECK(many.rules.min_friction.value() == 0.15);
    CHECK_FALSE(many.rig.reset);
    CHECK(many.wear_model.empty());
    CHECK(command<rig::bridge::StatusCommand>({"status", "tests/bridge", "--json", "-"}).json == "-");
    const auto before =
        command<rig::bridge::PreflightCommand>({"preflight", "config/scenarios/endurance.toml", "--can", "can0", "--plc", "10.0.0.2:502", "--out",
                                                "runs/1", "--maneuvers", "500", "--bitrate", "500000", "--json", "-"});
    CHECK(before.rig.plc == "10.0.0.2:502");
    CHECK(before.rig.out == "runs/1");
    CHECK(before.maneuvers == 500);
    CHECK(before.bitrate == 500'000);
    CHECK(before.json == "-");
    const auto amend = command<rig::bridge::AmendCommand>(
        {"ledger", "amend", "tests/bridge", "--maneuver", "31", "--energy-MJ", "0.974", "--who", "A. Rossi", "--why", "node restarted"});
    CHECK(amend.directory == "tests/bridge");
    CHECK(amend.number == 31);
    CHECK_FALSE(amend.attempt);
    CHECK(amend.energy_MJ == 0.974);
    CHECK(amend.who == "A. Rossi");
    CHECK(many.rig.specimen == rig::record::Specimen{});
    CHECK_FALSE(many.rig.quiet);
    const auto named = command<rig::bridge::CampaignCommand>({"campaign",    "config/scenarios/endurance.toml",
                                                              "--can",       "can0",
                                                              "--plc",       "10.0.0.2:502",
                                                              "--out",       "runs/1",
                                                              "--maneuvers", "5",
                                                              "--brake",     "B1",
                                                              "--disc",      "D7",
                                                              "--tyre",      "T2",
                                                              "--specimen",  "S",
                                                              "--operator",  "Rossi",
                                                              "--notes",     "a, b",
                                                              "--quiet",     "--on-abort",
                                                              "/bin/true",   "--held"});
    CHECK_FALSE(named.held_by.empty());
    CHECK(many.held_by.empty());
    CHECK(named.rig.specimen == rig::record::Specimen{"B1", "D7", "T2", "S", "Rossi", "a, b"});
    CHECK(named.rig.quiet);
    CHECK(named.rig.on_abort == "/bin/true");
    const auto note = command<rig::bridge::NoteCommand>(
        {"ledger", "note", "tests/bridge", "--maneuver", "3", "--attempt", "2", "--disc", "D8", "--who", "A. Rossi"});
    CHECK(note.number == 3);
    CHECK(note.attempt == 2);
    CHECK(note.said.disc == "D8");
    CHECK_THROWS_WITH(parse({"ledger", "note", "tests/bridge", "--maneuver", "3", "--who", "A. Rossi"}), ContainsSubstring("nothing is said"));
    const auto read =
        command<rig::bridge::NoteCommand>({"ledger", "note", "tests/bridge", "--maneuver", "3", "--lining-worn", "0.31", "--who", "Kim"});
    CHECK(read.worn.at(0) == "0.31");
    CHECK(read.worn.at(1).empty());
    CHECK_FALSE(read.attempt);
    for (const char* const bad : {"31", "nan", "31 %"})
        CHECK_THROWS_WITH(parse({"ledger", "note", "tests/bridge", "--maneuver", "3", "--tread-worn", bad, "--who", "Kim"}),
                          ContainsSubstring("--tread-worn: '" + std::string(bad) + "' is no worn share"));
    const auto watch = command<rig::bridge::WatchCommand>({"watch", "tests/bridge", "--can", "can0", "--once", "--json", "-"});
    CHECK(watch.directory == "tests/bridge");
    CHECK(watch.once);
    CHECK(watch.json == "-");
    const auto pause = command<rig::bridge::HoldCommand>({"pause", "tests/bridge", "--who", "Rossi", "--why", "tyre"});
    CHECK(pause.hold);
    CHECK(pause.who == "Rossi");
    CHECK(pause.why == "tyre");
    CHECK_FALSE(command<rig::bridge::HoldCommand>({"resume", "tests/bridge"}).hold);
    CHECK(amend.why == "node restarted");
    CHECK(rig::bridge::ledger_file("runs/1") == "runs/1/campaign.sqlite");
}

TEST_CASE("Mistakes end with status 2 or say what would be right", "[BRG-430]") {
    CHECK(std::get<int>(parse({})) == 2);
    CHECK(std::get<int>(parse({"fly"})) == 2);
    CHECK(std::get<int>(parse({"maneuver", "config/scenarios/light.toml", "--plc", "1.2.3.4:5"})) == 2);
    CHECK(std::get<int>(parse({"maneuver", "config/scenarios/light.toml", "--can", "c", "--plc", "1.2.3.4:5", "--plc-rtu", "/dev/x"})) == 2);
    CHECK(std::get<int>(parse({"campaign", "config/scenarios/light.toml", "--can", "c", "--plc", "1.2.3.4:5", "--out", "o"})) == 2);
    CHECK(std::get<int>(parse({"campaign", "config/scenarios/light.toml", "--can", "c", "--plc", "1.2.3.4:5", "--out", "o", "--maneuvers", "0"})) ==
          2);
    CHECK(std::get<int>(parse({"preflight", "config/scenarios/light.toml", "--plc", "1.2.3.4:5"})) == 2);
    CHECK_THROWS_WITH(parse({"preflight", "config/scenarios/light.toml", "--can", "c"}), ContainsSubstring("--plc HOST:PORT"));
    CHECK(std::get<int>(parse({"ledger"})) == 2);
    CHECK(std::get<int>(parse({"ledger", "amend", "tests/bridge", "--maneuver", "31", "--energy-MJ", "1"})) == 2);
    for (const char* const energy : {"nan", "-nan", "inf"})
        CHECK(std::get<int>(parse({"ledger", "amend", "tests/bridge", "--maneuver", "31", "--energy-MJ", energy, "--who", "Kim", "--why", "log"})) ==
              2);
    CHECK(std::get<int>(parse({"campaign", "config/scenarios/light.toml", "--can", "c", "--plc", "1.2.3.4:5", "--out", "o", "--maneuvers", "1",
                               "--min-friction", "nan"})) == 2);
    CHECK(std::get<int>(parse({"--help"})) == 0);
    // Nobody to say that it is abnormal.
    CHECK(std::get<int>(parse({"campaign", "config/scenarios/light.toml", "--can", "c", "--plc", "1.2.3.4:5", "--out", "o", "--maneuvers", "1",
                               "--stop-on-abnormal"})) == 2);
    CHECK_THROWS_WITH(parse({"maneuver", "config/scenarios/light.toml", "--can", "c"}), ContainsSubstring("--plc HOST:PORT or --plc-rtu DEVICE"));
    CHECK_THROWS_WITH(parse({"maneuver", "config/scenarios/light.toml", "--can", "c", "--plc-rtu", "COM3"}), ContainsSubstring("/dev/ttyUSB0"));
}
