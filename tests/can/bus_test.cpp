#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include "firmware/can/candump.hpp"
#include "firmware/can/loopback.hpp"
#include "firmware/can/schedule.hpp"
#include "firmware/can/socket_can.hpp"
#include "firmware/can/wall_clock_offset.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

using namespace antiskid;
using namespace antiskid::can;
using control::Time;

namespace {

/// Longest classic frame with an 11-bit identifier and `length` data bytes, in bit times: after the first five equal bits, every fourth adds a stuff
/// bit.
std::uint32_t worst_case_bits(std::uint32_t length) {
    const std::uint32_t stuffed = 1 + 11 + 1 + 1 + 1 + 4 + 8 * length + 15;  // SOF, ID, RTR, IDE, r0, DLC, data, CRC
    std::uint32_t stuff_bits = 0;
    std::uint32_t run = 0;
    for (std::uint32_t i = 0; i < stuffed; ++i) {
        ++run;  // the worst contents go on at the level of the last stuff bit
        if (run == 5) {
            ++stuff_bits;
            run = 1;  // the stuff bit starts the next run
        }
    }
    return stuffed + stuff_bits + 1 + 1 + 1 + 7 + 3;  // CRC delimiter, ACK slot and delimiter, EOF, interframe space
}

/// Share of the bit rate with worst-case bit stuffing, 0 to 1.
struct BusLoad {
    double mean = 0.0;
    double peak = 0.0;  ///< of the fullest control period, if rig and controller step together
};

/// Counts every cyclic message of `layout` at the control period `step`, and one SYNC per step if `with_sync`.
BusLoad bus_load(const Layout& layout, Time step, std::uint32_t bitrate_bps, bool with_sync) {
    const Schedule schedule(layout, step);
    const double step_s = static_cast<double>(step.count()) * 1e-9;
    // Ten seconds have every combination of the periods that occur in practice (at most a second).
    const auto steps = static_cast<std::uint32_t>(std::lround(10.0 / step_s));
    double sum = 0.0, fullest = 0.0;
    for (std::uint32_t index = 0; index < steps; ++index) {
        double bits = 0.0;
        for (std::size_t i = 0; i < kRoleCount; ++i) {
            const auto role = static_cast<Role>(i);
            const bool sent = schedule.due(role, index) || (role == Role::sync && with_sync && layout[role].bound);
            if (sent) bits += worst_case_bits(layout[role].length);
        }
        sum += bits;
        fullest = std::max(fullest, bits);
    }
    const double bits_per_step = static_cast<double>(bitrate_bps) * step_s;
    return {.mean = sum / steps / bits_per_step, .peak = fullest / bits_per_step};
}

std::string load_table(const Layout& layout) {
    std::string table;
    for (const int step_ms : {1, 2, 5}) {
        for (const bool with_sync : {false, true}) {
            const BusLoad load = bus_load(layout, std::chrono::milliseconds(step_ms), 1'000'000, with_sync);
            std::array<char, 100> row{};
            std::snprintf(row.data(), row.size(), "| %d ms | %s | %.1f %% | %.1f %% |\n", step_ms, with_sync ? "SYNC" : "timer", 100.0 * load.mean,
                          100.0 * load.peak);
            table += row.data();
        }
    }
    return table;
}

}  // namespace

TEST_CASE("the longest frame by counting bits is that of Davis, Burns, Bril and Lukkien, 2007, eq. 1", "[CAN-058]") {
    for (std::uint32_t length = 0; length <= 8; ++length) CHECK(worst_case_bits(length) == 55 + 10 * length);
}

TEST_CASE("the bus carries our layout at 1 kHz with room to spare, and the docs state the load", "[CAN-058]") {
    // By hand, bits in a second at 1 kHz: wheel and flywheel 135, pressure and valve 95, each 1000 times;
    // maneuver and road 135 at 50; status 135, faults 115, load cells 135 at 100; two heartbeats 75, maneuver state 115 at 10.
    const double bits = 1000.0 * (135 + 135 + 95 + 95) + 50.0 * (135 + 135) + 100.0 * (135 + 115 + 135) + 10.0 * (75 + 75 + 115);
    const BusLoad load = bus_load(can_test::ours(), std::chrono::milliseconds(1), 1'000'000, false);
    CHECK(load.mean == Approx(bits / 1e6));
    CHECK(load.peak < 0.8);
    const std::string docs = can_test::contents("docs/user/can.md");
    INFO(load_table(can_test::ours()) << load_table(can_test::foreign()));
    CHECK_THAT(docs, ContainsSubstring(load_table(can_test::ours())));
    CHECK_THAT(docs, ContainsSubstring(load_table(can_test::foreign())));
}

TEST_CASE("SYNC loads the bus only where the layout has one", "[CAN-058][CAN-201]") {
    Layout without = can_test::ours();
    without[Role::sync].bound = false;
    const auto mean = [](const Layout& layout, bool with_sync) { return bus_load(layout, std::chrono::milliseconds(1), 1'000'000, with_sync).mean; };
    CHECK(mean(without, true) == mean(without, false));
    CHECK(mean(can_test::ours(), true) > mean(can_test::ours(), false));
}

TEST_CASE("the mean load is bits over time, for a period that fills ten seconds and not eleven", "[CAN-058]") {
    Layout one;
    one[Role::pressure] = {.id = 1, .length = 4, .bound = true, .period = std::chrono::milliseconds(400), .protection = {}};
    const BusLoad load = bus_load(one, std::chrono::milliseconds(1), 1'000'000, false);
    CHECK(load.mean == Approx(worst_case_bits(4) / 0.4 / 1e6).epsilon(1e-9));
    CHECK(load.peak == Approx(worst_case_bits(4) / 1e3));
    // Faster than every step is every step.
    one[Role::pressure].period = Time{1};
    CHECK(bus_load(one, std::chrono::milliseconds(1), 1'000'000, false).mean == Approx(worst_case_bits(4) / 1e3));
}

TEST_CASE("the clocks are compared every 1024 batches, and where a stamp goes back", "[CAN-081]") {
    int looks = 0;
    WallClockOffset offset([&looks] {
        ++looks;
        return ClockReading{.wall_minus_monotonic = Time{1'000}, .monotonic = Time{1'000'000}};
    });
    CHECK(looks == 1);
    for (const int rounds : {1, 2, 3}) {
        for (int batch = 1; batch < 1024; ++batch) offset.next_batch();
        CHECK(looks == rounds);
        offset.next_batch();
        CHECK(looks == rounds + 1);
    }
    CHECK(offset.monotonic(Time{501'000}) == Time{500'000});
    CHECK(offset.monotonic(Time{501'000}) == Time{500'000});
    CHECK(looks == 4);
    CHECK(offset.monotonic(Time{500'999}) == Time{499'999});
    CHECK(looks == 5);
}

TEST_CASE("the loopback delivers to every other end, in order, with the time that was set", "[CAN-070]") {
    Loopback hub;
    Loopback::End& a = hub.connect();
    Loopback::End& b = hub.connect();
    Loopback::End& c = hub.connect();
    hub.set_time(Time{7});
    for (std::uint32_t id = 1; id <= 3; ++id) CHECK(a.send({.id = id, .length = 0, .data = {}, .received = {}}));
    CHECK(b.send({.id = 4, .length = 0, .data = {}, .received = {}}));
    std::array<Frame, 8> frames;
    CHECK(c.wait(Time{0}));
    REQUIRE(c.receive(std::span(frames).first(3)) == 3);
    CHECK(frames[2].id == 3);
    REQUIRE(c.receive(frames) == 1);
    CHECK(frames[0].id == 4);
    CHECK(frames[0].received == Time{7});
    CHECK(b.receive(frames) == 3);
    CHECK(a.receive(frames) == 1);
    CHECK_FALSE(a.wait(Time{1'000'000'000}));
    CHECK(a.receive(frames) == 0);
}

TEST_CASE("a full receive queue drops the newest and counts; a link that is down neither sends nor receives", "[CAN-070]") {
    Loopback hub;
    Loopback::End& a = hub.connect();
    Loopback::End& b = hub.connect();
    for (std::uint32_t i = 0; i < Loopback::kQueue + 5; ++i) {
        CHECK(a.send({.id = i, .length = 0, .data = {}, .received = {}}));
    }
    CHECK(b.status().receive_dropped == 5);
    std::array<Frame, Loopback::kQueue> frames;
    REQUIRE(b.receive(frames) == Loopback::kQueue);
    CHECK(frames.back().id == Loopback::kQueue - 1);

    b.set_link(true, true);
    CHECK(b.status().bus_off);
    CHECK_FALSE(b.status().up);
    CHECK(b.status().bus_off_events == 1);
    CHECK(b.status().error_frames == 1);
    CHECK_FALSE(b.send({}));
    CHECK(b.status().transmit_dropped == 1);
    CHECK(a.send({}));
    CHECK(b.receive(frames) == 0);
    b.set_link(true, true);
    CHECK(b.status().bus_off_events == 1);  // the same one still
    b.set_link(false, false);
    CHECK_FALSE(b.status().bus_off);
    CHECK_FALSE(b.status().up);
    CHECK_FALSE(b.send({}));
    b.set_link(true, false);
    CHECK(b.send({}));
    CHECK(a.receive(frames) == 1);
}

TEST_CASE("a bus that has no better way waits, receives and sends frame by frame", "[CAN-058]") {
    /// Its first frame arrives during the wait, and it takes two.
    class Slow final : public Bus {
      public:
        std::size_t receive(std::span<Frame> frames) override {
            if (!arrived) return 0;
            frames[0] = {.id = 5, .length = 0, .data = {}, .received = {}};
            return 1;
        }
        bool send(const Frame&) override { return sent < 2 && ++sent > 0; }
        bool wait(Time timeout) override { return arrived = timeout > Time{0}; }
        [[nodiscard]] LinkStatus status() const override { return {}; }
        bool arrived = false;
        int sent = 0;
    };
    Slow bus;
    std::array<Frame, 3> frames;
    CHECK(bus.receive_within(Time{0}, frames) == 0);
    REQUIRE(bus.receive_within(Time{1}, frames) == 1);
    CHECK(frames[0].id == 5);
    CHECK(bus.receive_within(Time{0}, frames) == 1);  // it was there: no wait
    CHECK(bus.arrived);
    CHECK(bus.send_all(std::span(frames).first(1)) == 1);
    CHECK(bus.send_all(frames) == 1);
    CHECK(bus.send_all({}) == 0);
}

TEST_CASE("without the interface, or without CAN in the kernel, the refusal says so", "[CAN-080]") {
    // Which of the two depends on the machine; over a real vcan each refusal is tested by itself.
    CHECK_THROWS_WITH(SocketCan("vcan_no_such", {}), ContainsSubstring("CAN interface 'vcan_no_such'") &&
                                                         (ContainsSubstring("does not exist: make it with `ip link add") ||
                                                          ContainsSubstring("this kernel has no CAN (`modprobe can_raw`, or run under `./rig vcan")));
}

TEST_CASE("candump lines are read", "[CAN-050]") {
    const auto parsed = [](std::string_view line) { return std::get<CandumpLine>(parse_candump(line)); };
    const CandumpLine line = parsed("(1436509053.650713) vcan0 044#2A366C2BBA\n");
    CHECK(line.time == Time{1'436'509'053'650'713'000});
    CHECK(line.interface == "vcan0");
    CHECK(line.frame.id == 0x44);
    CHECK(line.frame.length == 5);
    CHECK(line.frame.data == std::array<std::uint8_t, 8>{0x2A, 0x36, 0x6C, 0x2B, 0xBA, 0, 0, 0});
    CHECK(line.frame.received == line.time);
    CHECK(parsed("(0000000000.000001) can0 7FF#").frame.length == 0);
    CHECK(parsed("(1.5) can0 7ff#aAbB").frame.data[1] == 0xBB);
    CHECK(parsed("(1.123456789) can0 123#00 R\r\n").time == Time{1'123'456'789});
    CHECK(parsed("(1.5) can0 1F334455#1122334455667788 T").extended);
    CHECK(parsed("(1.5) can0 123#R8").remote);
    CHECK(parsed("(1.5) can0 123#R").frame.length == 0);
    CHECK(parsed("(1.5)   can0   123#00").interface == "can0");
    CHECK(parsed("(1436509053.650713)  vcan0 044#2A").interface == "vcan0");
    CHECK(parsed("(1436509053.650713) vcan0 123#R").remote);
    CHECK(parsed("(1436509053.650713) vcan0 1F334455#00").extended);
    CHECK(parsed("(9000000000.999999) vcan0 044#2A").time == Time{9'000'000'000'999'999'000});
    const CandumpLine error = parsed("(1.5) can0 20000040#0000000000000000");
    CHECK(error.error);
    CHECK_FALSE(error.extended);
    CHECK(error.frame.id == 0x40);
}

TEST_CASE("lines that are no candump lines are refused with the column", "[CAN-050]") {
    const auto rejected = [](std::string_view line, std::size_t column, const std::string& what) {
        INFO(line);
        const auto result = parse_candump(line);
        REQUIRE(std::holds_alternative<CandumpFailure>(result));
        CHECK(std::get<CandumpFailure>(result).column == column);
        CHECK_THAT(std::get<CandumpFailure>(result).what, ContainsSubstring(what));
    };
    rejected("", 1, "time");
    rejected("hello", 1, "time");
    rejected("(1) can0 123#00", 3, "time");
    rejected("(9999999999.0) can0 123#00", 11, "below 9e9 s");
    rejected("(1.5)can0 123#00", 6, "interface");
    rejected("(1.5) ", 7, "interface");
    rejected("(1.5) can0", 11, "frame");
    rejected("(1.5) can0 12#00", 14, "three or eight");
    rejected("(1.5) can0 800#00", 15, "000 to 7FF");
    rejected("(1.5) can0 FFFFFFFF#00", 20, "below 40000000");
    rejected("(1.5) can0 123456789#00", 20, "three or eight");
    rejected("(1.5) can0 123", 15, "expected #");
    rejected("(1.5) can0 123##100", 16, "CAN FD");
    rejected("(1.5) can0 123#0", 17, "two hexadecimal digits");
    rejected("(1.5) can0 123#112233445566778899", 32, "at most eight");
    rejected("(1.5) can0 123#00x", 18, "end of the line");
    rejected("(1.1234567890) can0 123#00", 13, "nine decimals");
    rejected("(", 2, "time");
    rejected("(x.5) can0 123#00", 2, "time");
    rejected("(:.5) can0 123#00", 2, "time");
    rejected("(1.x) can0 123#00", 4, "time");
    rejected("(1.5 can0 123#00", 5, "time");
    rejected("(1.5) can0 12g#00", 14, "three or eight");
    rejected("(1.5) can0 123#R9", 17, "end of the line");
    rejected("(1.5) can0 123#R/", 17, "end of the line");
    rejected("(1.5) can0 123#00 X", 18, "end of the line");
    // Of the length and form that nearly every line has, one character wrong at a time.
    rejected("[1436509053.650713) vcan0 044#2A", 1, "time");
    rejected("(1436509053,650713) vcan0 044#2A", 12, "time");
    rejected("(1436509053.650713] vcan0 044#2A", 19, "time");
    rejected("(1436509053.650713)_vcan0 044#2A", 20, "interface");
    rejected("(143650905x.650713) vcan0 044#2A", 11, "time");
    rejected("(1436509053.65071x) vcan0 044#2A", 18, "time");
    rejected("(9000000001.650713) vcan0 044#2A", 11, "below 9e9 s");
    rejected("(1436509053.650713) vcan0_044#2A", 33, "frame");
    rejected("(1436509053.650713) vcan0 04", 29, "three or eight");
    rejected("(1436509053.650713) vcan0 044_2A", 30, "expected #");
    rejected("(1436509053.650713) vcan0 0g4#2A", 28, "three or eight");
    rejected("(1436509053.650713) vcan0 944#2A", 30, "000 to 7FF");
    rejected("(1436509053.650713) vcan0 044#2", 32, "two hexadecimal digits");
    rejected("(1436509053.650713) vcan0 044#2x", 32, "two hexadecimal digits");
    rejected("(1436509053.650713) vcan0 044#112233445566778899", 47, "at most eight");
}

TEST_CASE("remote, extended and error frames are written as candump has them", "[CAN-050][CAN-201]") {
    const auto written = [](const CandumpLine& line) {
        std::array<char, kCandumpLineMax> text{};
        return std::string(text.data(), format_candump(line, text));
    };
    CandumpLine line;
    line.time = Time{1'500'000'000};
    line.interface = "can0";
    line.frame = {.id = 0x1A, .length = 0, .data = {}, .received = {}};
    line.remote = true;
    CHECK(written(line) == "(0000000001.500000) can0 01A#R");
    line.frame.length = 8;
    CHECK(written(line) == "(0000000001.500000) can0 01A#R8");
    line.remote = false;
    line.extended = true;
    line.frame.length = 1;
    CHECK(written(line) == "(0000000001.500000) can0 0000001A#00");
    line.extended = false;
    line.error = true;
    CHECK(written(line) == "(0000000001.500000) can0 2000001A#00");
    for (const std::string& text : {std::string("(0000000001.500000) can0 01A#R8"), std::string("(0000000001.500000) can0 0000001A#00"),
                                    std::string("(0000000001.500000) can0 2000001A#00")})
        CHECK(written(std::get<CandumpLine>(parse_candump(text))) == text);
}

TEST_CASE("what is written is read again, and fits or is refused whole", "[CAN-050]") {
    std::mt19937 random(90);
    const auto draw = [&random](std::int64_t max) { return std::uniform_int_distribution<std::int64_t>(0, max)(random); };
    for (int i = 0; i < 2000; ++i) {
        Frame frame;
        frame.id = static_cast<std::uint32_t>(draw(0x7FF));
        frame.length = static_cast<std::uint8_t>(draw(8));
        for (std::size_t k = 0; k < frame.length; ++k) frame.data[k] = static_cast<std::uint8_t>(draw(255));
        const Time time{draw(8'000'000'000'000'000) * 1000};
        std::array<char, kCandumpLineMax> text{};
        const std::size_t size = format_candump(time, "interface123456", frame, text);
        REQUIRE(size != 0);
        const auto line = std::get<CandumpLine>(parse_candump({text.data(), size}));
        CHECK(line.time == time);
        CHECK(line.frame.id == frame.id);
        CHECK(line.frame.length == frame.length);
        CHECK(line.frame.data == frame.data);
        CHECK(format_candump(time, "interface123456", frame, std::span(text).first(size - 1)) == 0);
    }
    std::array<char, kCandumpLineMax> text{};
    const Frame frame{.id = 0x1A, .length = 2, .data = {0, 0xFF}, .received = {}};
    CHECK(std::string_view(text.data(), format_candump(Time{1'002'003'004}, "vcan0", frame, text)) == "(0000000001.002003) vcan0 01A#00FF");
}

TEST_CASE("wall-clock stamps become monotonic ones, and a step of the wall clock does not last", "[CAN-081]") {
    Time offset{1'000'000'000'000};
    int readings = 0;
    std::int64_t now = 0;
    const auto clock = [&offset, &readings, &now] {
        ++readings;
        return ClockReading{.wall_minus_monotonic = offset, .monotonic = Time{now}};
    };
    WallClockOffset mapping(clock);
    CHECK(readings == 1);
    const auto stamp = [&](std::int64_t advance) {
        now += advance;
        mapping.next_batch();
        return (mapping.monotonic(Time{now} + offset) - Time{now}).count();
    };
    static_cast<void>(stamp(1'000'000));
    const int settled = readings;
    for (int i = 0; i < 500; ++i) CHECK(stamp(1'000'000) == 0);
    CHECK(readings == settled);  // no clock is read from frame to frame
    offset += Time{3'600'000'000'000};
    CHECK(stamp(1'000'000) == 0);
    offset -= Time{7'200'000'000'000};
    CHECK(stamp(1'000'000) == 0);
    offset += Time{500'000};  // too small to be seen at once
    CHECK(stamp(1'000'000) == 500'000);
    std::int64_t error = 0;
    for (int i = 0; i < 1024; ++i) error = stamp(1'000'000);
    CHECK(error == 0);
}
