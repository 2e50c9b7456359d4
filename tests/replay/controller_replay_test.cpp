// Logs made in process by the real controller; what must come out is what is in them.
#include "rig_bridge/replay/controller_replay.hpp"

#include <cmath>

#include "firmware/control/controller.hpp"
#include "tests/catch.hpp"
#include "tests/replay/landings.hpp"

using namespace replay_test;
using antiskid::can::Role;

namespace {

antiskid::controller::ControllerSetup setup_of(const plant_sim::StopOptions& o) {
    antiskid::controller::Options options;
    if (o.choice.maneuver == rig::kEndurance) options.controller = "config/controller_endurance.toml";
    options.layout = antiskid::LayoutFiles("config", o.dbc, o.binding);
    return antiskid::controller::load_setup(options);
}

rig::replay::ControllerReplayReport replay(const std::filesystem::path& log, const antiskid::controller::ControllerSetup& setup,
                                           rig::replay::ReplayClock clock = rig::replay::ReplayClock::automatic) {
    rig::replay::LogWarnings warnings("bus.log", {});
    return rig::replay::replay_controller(log, {}, setup, clock, warnings);
}

const std::string& wet_landing() {
    static const std::string log = landing(scenarios::options({"wet_asphalt", "light"}));
    return log;
}

bool is(const std::string& line, const char* id) {
    return line.find(std::string(" ") + id + "#") != std::string::npos;
}

std::string joined(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += line;
    return text;
}

}  // namespace

TEST_CASE("lockstep logs of every law and layout: no command frame differs", "[BRG-310]") {
    const TempDir dir;
    std::vector<plant_sim::StopOptions> runs{scenarios::options({"dry_asphalt", "heavy"}), scenarios::options({"snow", "medium_a"}, "threshold"),
                                             scenarios::options({"dry_concrete", "endurance"}, "deceleration"),
                                             scenarios::options({"wet_asphalt", "light"})};
    runs.back().dbc = "config/foreign.dbc";
    runs.back().binding = "config/foreign_binding.toml";
    for (const auto& options : runs) {
        INFO(options.choice.maneuver << " on " << options.choice.surface << ", " << options.law);
        const std::string text = landing(options);
        const auto report = replay(dir.write("bus.log", text), setup_of(options));
        const auto& commands = report.count(Role::valve);
        CHECK(report.lockstep);
        CHECK(commands.compared > 5000);
        CHECK(commands.different == 0);
        CHECK(commands.only_recorded == 0);
        CHECK(commands.only_replayed == 0);
        CHECK(report.same());
        CHECK_FALSE(report.first);
        for (const Role role : {Role::status, Role::faults, Role::controller_heartbeat}) CHECK(report.count(role).different == 0);
        CHECK(report.steps == commands.compared);
        CHECK(report.unsynchronised == 0);
        CHECK(report.steps_before_log == 0);
        const auto packed = replay(write_gzip(dir.write("x", "").parent_path() / "a.gz", text), setup_of(options));
        CHECK(packed.count(Role::valve).compared == commands.compared);
        CHECK(packed.same());
    }
}

TEST_CASE("a command that is not the recorded one is named: line, time, expected, got", "[BRG-310]") {
    const TempDir dir;
    std::vector<std::string> lines = lines_of(wet_landing());
    std::size_t changed = 30'000;
    while (!is(lines[changed], "100")) ++changed;
    std::string& victim = lines[changed];
    const std::size_t digit = victim.find('#') + 6;
    victim[digit] = victim[digit] == '0' ? '1' : '0';
    const auto setup = setup_of({});
    const auto report = replay(dir.write("bus.log", joined(lines)), setup);
    CHECK(report.count(Role::valve).different == 1);
    CHECK_FALSE(report.same());
    REQUIRE(report.first);
    CHECK(report.first->line == changed + 1);
    CHECK(report.first->role == Role::valve);
    const std::string text = rig::replay::to_text(report, setup.layout);
    CHECK_THAT(text, ContainsSubstring("line " + std::to_string(changed + 1)));
    CHECK_THAT(text, ContainsSubstring("expected " + victim.substr(victim.find("100#"), 12)));
    CHECK_THAT(text, ContainsSubstring("1 of "));
}

TEST_CASE("another configuration than the recorded one shows", "[BRG-310]") {
    const TempDir dir;
    auto setup = setup_of({});
    setup.control.slip.k_p_per_s *= 1.01F;
    const auto report = replay(dir.write("bus.log", wet_landing()), setup);
    CHECK(report.count(Role::valve).different > 1000);
    REQUIRE(report.first);
    CHECK(report.first->time > antiskid::can::Time{1'400'000'000});
}

TEST_CASE("lines that are missing from a log do not shift what follows", "[BRG-310]") {
    const TempDir dir;
    const std::vector<std::string> whole = lines_of(wet_landing());
    const auto without = [&](const char* id, std::size_t from, std::size_t count) {
        std::vector<std::string> lines = whole;
        for (std::size_t at = from; count > 0; ++at) {
            if (!is(lines[at], id)) continue;
            lines[at].clear();
            --count;
        }
        return dir.write("bus.log", joined(lines));
    };
    const auto setup = setup_of({});
    const auto all = replay(dir.write("whole.log", wet_landing()), setup).count(Role::valve).compared;
    const auto commands = replay(without("100", 20'000, 3), setup);
    CHECK(commands.count(Role::valve).compared == all - 3);
    CHECK(commands.count(Role::valve).only_replayed == 3);
    CHECK(commands.count(Role::valve).different == 0);
    const auto status = replay(without("180", 20'000, 2), setup);
    CHECK(status.count(Role::status).only_replayed == 2);
    CHECK(status.count(Role::status).different == 0);
    CHECK(status.same());
    // A sensor frame that the controller had and the log has not: the commands after it differ, and no other.
    const auto sensor = replay(without("112", 20'000, 1), setup);
    CHECK(sensor.count(Role::valve).compared == all);
    CHECK(sensor.count(Role::valve).only_replayed == 0);
}

TEST_CASE("without SYNC the recorded commands end the steps, and missed periods are told", "[BRG-310]") {
    const TempDir dir;
    std::vector<std::string> lines = lines_of(wet_landing());
    for (std::string& line : lines)
        if (is(line, "080")) line.clear();
    const auto setup = setup_of({});
    const auto report = replay(dir.write("bus.log", joined(lines)), setup);
    CHECK_FALSE(report.lockstep);
    CHECK(report.steps > 5000);
    // The last three, at the safe current, pass for those with which a controller ends.
    CHECK(report.steps + 3 == report.count(Role::valve).compared);
    CHECK(report.count(Role::valve).different == 0);  // stamps in process are exact
    CHECK_THAT(rig::replay::to_text(report, setup.layout), ContainsSubstring("may differ"));
    const auto forced = replay(dir.write("sync.log", wet_landing()), setup, rig::replay::ReplayClock::timer);
    CHECK_FALSE(forced.lockstep);
    CHECK(forced.same());
}

TEST_CASE("a rig that repeats its first sample, and a controller that came later", "[BRG-310]") {
    const TempDir dir;
    std::vector<std::string> lines = lines_of(wet_landing());
    const auto setup = setup_of({});
    std::string first;
    std::size_t i = 0;
    for (; !is(lines[i], "080"); ++i) first += lines[i];
    first += lines[i];
    const auto repeated = replay(dir.write("bus.log", first + first + first + wet_landing()), setup);
    CHECK(repeated.same());
    CHECK(repeated.unanswered == 3);
}

TEST_CASE("a log that begins within a session of the controller", "[BRG-310]") {
    const TempDir dir;
    const auto setup = setup_of({});
    for (const bool with_sync : {true, false}) {
        INFO((with_sync ? "SYNC" : "timer"));
        std::string text;
        for (const std::string& line : lines_of(wet_landing()))
            if (line >= "(0000000000.003" && (with_sync || !is(line, "080"))) text += line;
        const auto report = replay(dir.write("bus.log", text), setup);
        CHECK(report.lockstep == with_sync);
        CHECK(report.steps_before_log == 3);
        INFO(rig::replay::to_text(report, setup.layout));
        const auto& commands = report.count(Role::valve);
        CHECK(commands.compared > 9000);
        CHECK(commands.only_recorded == 0);
        CHECK(commands.only_replayed == 0);
        // Brake-on comes 1.5 s later: of what the log lacks the estimators still remember less than a last digit, which the law's integrals keep.
        if (report.largest)
            CHECK(std::abs(rig::replay::current_difference_mA(*report.largest, setup.layout)) < 1.5 * setup.layout.valve_current_mA.scale);
        CHECK(report.count(Role::status).settling < 20);  // it has passed its test when it is armed at 0.2 s
        const auto& status = report.count(Role::status);  // the same last digits, in the slip that it tells
        CHECK(status.different < status.compared / 100);
        CHECK_THAT(rig::replay::to_text(report, setup.layout), ContainsSubstring("was running when the log began"));
    }
}

TEST_CASE("steps without SYNC and the closing commands of the controller", "[BRG-310]") {
    const TempDir dir;
    // The rig falls silent after the first 300 samples; the controller goes on alone, 40 steps, and ends.
    const auto setup = setup_of({});
    const auto machine = [&](std::size_t alone) {
        antiskid::can::ControllerPort port(setup.layout, setup.period);
        antiskid::control::Controller controller(setup.control);
        std::string log;
        antiskid::can::Time now{};
        const auto step = [&] {
            const auto command = controller.step(port.sensors(), now);
            port.clear_one_shots();
            std::array<antiskid::can::Frame, antiskid::can::ControllerPort::kMaxFrames> out{};
            const std::size_t count = port.due_frames(command, out);
            for (std::size_t k = 1; k < count; ++k) log += line(out[k]);
            log += line(out[0]);
            now += setup.period;
        };
        std::size_t samples = 0;
        for (const std::string& text : lines_of(wet_landing())) {
            const auto frame = std::get<antiskid::can::CandumpLine>(antiskid::can::parse_candump(text)).frame;
            if (is(text, "100") || is(text, "180") || is(text, "181") || is(text, "701")) continue;
            log += text;
            auto received = frame;
            received.received = now;
            port.accept(received);
            if (!is(text, "080")) continue;
            step();
            if (++samples == 300) break;
        }
        for (std::size_t k = 0; k < alone; ++k) step();
        for (int k = 0; k < 3; ++k) log += line(port.valve_command(setup.control.valve.safe_current_mA));
        return log;
    };
    for (const std::size_t alone : {std::size_t{0}, std::size_t{1}, std::size_t{40}}) {
        INFO(alone << " steps alone");
        const auto report = replay(dir.write("bus.log", machine(alone)), setup);
        CHECK(report.steps == 300 + alone);
        CHECK(report.unsynchronised == alone);
        CHECK(report.count(Role::valve).compared == 300 + alone + 3);
        CHECK(report.count(Role::valve).different == 0);
        CHECK(report.count(Role::status).only_recorded == 0);
        CHECK(report.same());
    }
}

TEST_CASE("a log without commands is refused, not called the same", "[BRG-310]") {
    const TempDir dir;
    CHECK_THROWS_WITH(replay(dir.write("bus.log", "(1.000000) vcan0 110#0011\n"), setup_of({})), ContainsSubstring("no valve command"));
}
