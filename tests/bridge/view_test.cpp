#include "rig_bridge/bridge/view.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cmath>

#include "rig_bridge/bridge/terminal.hpp"
#include "rig_bridge/modbus/pseudo_terminal.hpp"
#include "tests/catch.hpp"

using rig::Abort;
using rig::Phase;
using rig::bridge::CampaignView;
using rig::bridge::ViewModel;

namespace {

ViewModel braking() {
    ViewModel v;
    v.scenario = "Heavy landing, slip law";
    v.phase = Phase::braking;
    v.time_s = 27.5;
    v.phase_s = 2.25;
    v.prescribed_mps = 60.0;
    v.rim_mps = 30.0;
    v.wheel_mps = 24.0;
    v.slip = 0.2;
    v.pressure_Pa = 9.25e6;
    v.load_N = 43210.0;
    v.torque_Nm = 8765.0;
    v.temperature_C = 123.4;
    v.controller = "braking";
    v.plc = "ready";
    v.bus = "up";
    v.frames = 12345;
    return v;
}

std::string read_all(int descriptor) {
    std::array<char, 16384> buffer{};
    const ssize_t count = ::read(descriptor, buffer.data(), buffer.size());
    return count > 0 ? std::string(buffer.data(), static_cast<std::size_t>(count)) : std::string();
}

}  // namespace

TEST_CASE("The live block shows phase, speeds, slip, pressure, load, temperature and faults", "[BRG-420]") {
    ViewModel v = braking();
    const auto lines = screen(v, 200);
    REQUIRE(lines.size() == 6);
    CHECK(lines[0] == "Heavy landing, slip law");
    CHECK(lines[1] == "braking      27.50 s  [############............]  2.2 s in this phase");
    CHECK(lines[2] == "rim  30.00 m/s   wheel  24.00 m/s   slip  0.200");
    CHECK(lines[3] == "pressure  9.25 MPa   load  43.21 kN   torque   8.77 kN m   brake 123.4 °C");
    CHECK(lines[4] == "controller braking               PLC ready       bus up    12345 frames, 0 dropped");
    CHECK(lines[5] == "faults: none");
    v.faults = {"wheel_lost", "overrun"};
    v.abort = Abort::controller_fault;
    v.note = "PLC: no answer";
    const auto bad = screen(v, 200);
    CHECK(bad[1].ends_with("ABORT controller_fault"));
    CHECK(bad[5] == "faults: wheel_lost overrun   PLC: no answer");
}

TEST_CASE("The bar is the phase's share of the speed", "[BRG-420]") {
    const auto bar = [](Phase phase, double rim) {
        ViewModel v = braking();
        v.phase = phase;
        v.rim_mps = rim;
        const std::string line = screen(v, 200)[1];
        return std::count(line.begin(), line.end(), '#');
    };
    CHECK(bar(Phase::idle, 0.0) == 0);
    CHECK(bar(Phase::spin_up, 15.0) == 6);
    CHECK(bar(Phase::spin_up, 61.0) == 24);
    CHECK(bar(Phase::braking, 60.5) == 0);
    CHECK(bar(Phase::braking, 0.0) == 24);
    CHECK(bar(Phase::cool_down, 0.0) == 24);
    CHECK(bar(Phase::aborting, 30.0) == 0);
    CHECK(bar(Phase::spin_up, NAN) >= 0);
}

TEST_CASE("A campaign shows its progress and the time left", "[BRG-420]") {
    ViewModel v = braking();
    v.campaign = CampaignView{.number = 126, .finished = 125, .planned = 500, .left_s = 3 * 3600.0 + 12 * 60.0};
    CHECK(screen(v, 200)[0] ==
          "Heavy landing, slip law  maneuver 126  [######..................] 125 of 500 finished, 3 h 12 min "
          "left");
    CHECK(plain_line(v).ends_with("[126 of 500, 3 h 12 min left]"));
    v.campaign->left_s.reset();
    CHECK(screen(v, 200)[0].ends_with("125 of 500 finished, time left unknown"));
}

TEST_CASE("Durations are said as people say them", "[BRG-420]") {
    CHECK(rig::bridge::duration_text(0.0) == "0 s");
    CHECK(rig::bridge::duration_text(59.4) == "59 s");
    CHECK(rig::bridge::duration_text(59.6) == "1 min 00 s");
    CHECK(rig::bridge::duration_text(245.0) == "4 min 05 s");
    CHECK(rig::bridge::duration_text(3599.6) == "1 h 00 min");
    CHECK(rig::bridge::duration_text(360000.0) == "100 h 00 min");
    CHECK(rig::bridge::duration_text(NAN) == "?");
    CHECK(rig::bridge::duration_text(INFINITY) == "?");
    CHECK(rig::bridge::duration_text(-1.0) == "?");
}

TEST_CASE("No line is wider than the terminal, and no character is cut", "[BRG-420]") {
    ViewModel v = braking();
    v.faults.assign(20, "pressure_off_command");
    for (std::size_t columns = 0; columns < 120; ++columns) {
        for (const std::string& line : screen(v, columns)) {
            std::size_t width = 0;
            for (const char c : line) width += (static_cast<unsigned char>(c) & 0xC0U) != 0x80U ? 1U : 0U;
            CHECK(width <= columns);
        }
    }
    CHECK(rig::bridge::fit("a°C", 2) == "a°");
    CHECK(rig::bridge::fit("a°C", 1) == "a");
    CHECK(rig::bridge::fit("abc", 5) == "abc");
}

TEST_CASE("Elsewhere than on a terminal: a plain line a second and one for every phase", "[BRG-420]") {
    std::array<int, 2> ends{};
    REQUIRE(pipe(ends.data()) == 0);
    rig::bridge::Terminal terminal(ends[1]);
    ViewModel v = braking();
    int lines = 0;
    for (int i = 0; i < 300; ++i) {
        const double now = 100.0 + i * 0.01;
        v.phase = i < 150 ? Phase::braking : Phase::standstill;
        if (terminal.due(now, v.phase, v.abort)) {
            terminal.show(v, now);
            ++lines;
        }
    }
    const std::string text = read_all(ends[0]);
    CHECK(lines == 4);
    CHECK(std::count(text.begin(), text.end(), '\n') == lines);
    CHECK(text.find('\x1b') == std::string::npos);
    CHECK(text.find('\r') == std::string::npos);
    CHECK_THAT(text, ContainsSubstring("standstill"));
    close(ends[0]);
    close(ends[1]);
}

TEST_CASE("A reader who does not read holds nobody up", "[BRG-420]") {
    std::array<int, 2> ends{};
    REQUIRE(pipe(ends.data()) == 0);
    rig::bridge::Terminal terminal(ends[1]);
    for (int i = 0; i < 5000; ++i) terminal.show(braking(), i);
    close(ends[0]);
    close(ends[1]);
    SUCCEED("5000 lines into a full pipe");
}

TEST_CASE("In a campaign with a wear model the view has the brake's health", "[BRG-500]") {
    ViewModel v = braking();
    v.campaign = CampaignView{.number = 7, .finished = 6, .planned = 500, .left_s = 60.0};
    CHECK(screen(v, 200).size() == 6);
    v.campaign->health = rig::bridge::health_text({rig::record::HealthState::suspect, 0.812, "friction has dropped", "f00d"});
    REQUIRE(screen(v, 200).size() == 7);
    CHECK(screen(v, 200)[6] == "brake suspect (0.81 of its limit): friction has dropped");
    CHECK_THAT(plain_line(v), ContainsSubstring("brake suspect (0.81 of its limit)"));
    CHECK(rig::bridge::health_text({}) == "unknown");
}

TEST_CASE("The bell rings on a terminal and nowhere else", "[BRG-471]") {
    const rig::modbus::PseudoTerminal line;
    const int slave = ::open(line.path().c_str(), O_RDWR | O_NOCTTY);
    REQUIRE(slave >= 0);
    rig::bridge::Terminal(slave).ring();
    CHECK(read_all(line.master()) == "\a");
    ::close(slave);
    std::array<int, 2> ends{};
    REQUIRE(pipe(ends.data()) == 0);
    rig::bridge::Terminal(ends[1]).ring();
    close(ends[1]);
    CHECK(read_all(ends[0]).empty());
    close(ends[0]);
}
