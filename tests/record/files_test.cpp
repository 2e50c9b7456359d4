#include <sys/resource.h>

#include <bit>
#include <csignal>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "firmware/can/candump.hpp"
#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/json.hpp"
#include "rig_bridge/record/append_file.hpp"
#include "rig_bridge/record/bus_log.hpp"
#include "rig_bridge/record/bus_meter.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/record/sample_log.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "tests/catch.hpp"
#include "tests/record/closed_form.hpp"
#include "tests/record/lines.hpp"

using namespace record_test;
using can_test::TempDir;
using record_test::lines;
using rig::record::BusLog;
using rig::record::CapturedFrame;

namespace {

CapturedFrame captured(std::uint32_t id, std::uint8_t length, std::int64_t us) {
    CapturedFrame out;
    out.frame = {.id = id, .length = length, .data = {0xDE, 0xAD, 0xBE, 0xEF, 1, 2, 3, 4}, .received = Time{us * 1000 + 789}};
    return out;
}

/// Files of this process may not grow beyond `bytes` while it lives: what a full disk does.
class FileLimit {
  public:
    explicit FileLimit(rlim_t bytes) {
        getrlimit(RLIMIT_FSIZE, &before_);
        handler_ = std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{.rlim_cur = bytes, .rlim_max = before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileLimit() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    FileLimit(const FileLimit&) = delete;
    FileLimit& operator=(const FileLimit&) = delete;

  private:
    rlimit before_{};
    void (*handler_)(int) = nullptr;
};

rig::record::Summary some_summary() {
    rig::record::Summary s;
    s.campaign = "endurance \"A\"\n";
    s.number = 42;
    s.scenario = "endurance";
    s.outcome = "finished";
    s.started = "2026-01-02T03:04:05Z";
    s.faults = {"wheel_lost", "bus_off"};
    s.frames = 51'000;
    s.frames_dropped = 3;
    s.seed = std::numeric_limits<std::uint64_t>::max();
    s.version = "0.1.0";
    s.config_hash = "0123456789abcdef";
    return s;
}

}  // namespace

TEST_CASE("bus.log has what candump would have written", "[BRG-210]") {
    const TempDir dir;
    const auto path = dir.write("x", "").parent_path() / "run" / "bus.log";
    {
        BusLog log(path, "vcan0");
        log.write(captured(0x7, 0, 1'436'509'053'650'713));
        log.write(captured(0x123, 4, 1'436'509'053'650'714));
        CapturedFrame frame = captured(0x123, 8, 1'436'509'053'999'999);
        frame.extended = true;
        log.write(frame);
        frame = captured(0x123, 0, 1'436'509'054'000'000);
        frame.remote = true;
        log.write(frame);
        frame.frame.length = 8;
        log.write(frame);
        frame = captured(0x40, 8, 1'436'509'054'000'001);
        frame.error = true;
        log.write(frame);
        CHECK(log.finish());
        CHECK(log.frames() == 6);
        CHECK(log.error().empty());
    }
    const std::vector<std::string> expected{
        "(1436509053.650713) vcan0 007#",  "(1436509053.650714) vcan0 123#DEADBEEF", "(1436509053.999999) vcan0 00000123#DEADBEEF01020304",
        "(1436509054.000000) vcan0 123#R", "(1436509054.000000) vcan0 123#R8",       "(1436509054.000001) vcan0 20000040#DEADBEEF01020304"};
    CHECK(lines(path) == expected);
    CHECK_THROWS_WITH(BusLog(path, "vcan0"), ContainsSubstring("bus.log: File exists"));
    CHECK_THROWS_WITH(BusLog("/proc/no/bus.log", "vcan0"), ContainsSubstring("/proc/no"));
}

TEST_CASE("a frame is with the kernel a second later at most", "[BRG-210]") {
    const TempDir dir;
    const auto path = dir.write("x", "").parent_path() / "bus.log";
    BusLog log(path, "vcan0");
    std::int64_t us = 1'000'000'000;
    for (int i = 0; i < 100; ++i, us += 100'000) {
        log.write(captured(0x100, 8, us));
        CHECK(lines(path).size() + 10 >= log.frames());
    }
}

TEST_CASE("a frame with a time that no log can have is missing, and said to be", "[BRG-210]") {
    const TempDir dir;
    const auto path = dir.write("x", "").parent_path() / "bus.log";
    BusLog log(path, "vcan0");
    log.write(captured(0x100, 0, 1));
    log.write(captured(0x100, 0, -1'000'000));
    log.write(captured(0x100, 0, 2));
    CHECK(log.frames() == 3);
    CHECK(log.missing() == 1);
    CHECK_FALSE(log.finish());
    CHECK(log.error() == "1 frame has a time stamp that no log can have (below 0 or above 9e9 s)");
    CHECK(lines(path) == std::vector<std::string>{"(0000000000.000001) vcan0 100#", "(0000000000.000002) vcan0 100#"});
}

TEST_CASE("every recorded frame comes back from its line", "[BRG-210]") {
    const TempDir dir;
    const auto path = dir.write("x", "").parent_path() / "bus.log";
    std::mt19937 random(210);
    std::vector<CapturedFrame> sent;
    {
        BusLog log(path, "can1");
        for (int i = 0; i < 20'000; ++i) {
            CapturedFrame frame = captured(0, 0, 1'000'000'000'000'000 + std::int64_t{97} * i);
            const auto kind = random() % 4;
            frame.extended = kind == 1;
            frame.remote = kind == 2;
            frame.error = kind == 3;
            frame.frame.id = static_cast<std::uint32_t>(random()) % (kind == 0 || kind == 2 ? 0x800U : 0x20000000U);
            frame.frame.length = frame.error ? 8 : static_cast<std::uint8_t>(random() % 9);
            for (std::uint8_t& byte : frame.frame.data) byte = static_cast<std::uint8_t>(random());
            log.write(frame);
            sent.push_back(frame);
        }
    }
    const auto text = lines(path);
    REQUIRE(text.size() == sent.size());
    bool same = true;
    for (std::size_t i = 0; i < sent.size(); ++i) {
        const auto parsed = antiskid::can::parse_candump(text[i]);
        const auto* line = std::get_if<antiskid::can::CandumpLine>(&parsed);
        REQUIRE(line != nullptr);
        const CapturedFrame& frame = sent[i];
        same = same && line->interface == "can1" && line->time.count() == frame.frame.received.count() / 1000 * 1000 &&
               line->frame.id == frame.frame.id && line->frame.length == frame.frame.length && line->extended == frame.extended &&
               line->remote == frame.remote && line->error == frame.error &&
               (frame.remote || std::equal(frame.frame.payload().begin(), frame.frame.payload().end(), line->frame.payload().begin()));
    }
    CHECK(same);
}

TEST_CASE("figures rebuilt from bus.log have the bits of the live ones", "[BRG-200]") {
    for (const bool sync : {true, false}) {
        const TempDir dir;
        const auto path = dir.write("x", "").parent_path() / "bus.log";
        ClosedForm c;
        c.jitter_s = 2e-6;
        const Recording recording(c, sync);
        rig::record::BusMeter live(can_test::ours(), kRig);
        {
            BusLog log(path, "vcan0");
            std::mt19937 random(211);
            for (Frame frame : recording.frames) {
                frame.received += Time{static_cast<std::int64_t>(random() % 1000)};  // the kernel stamps nanoseconds
                log.write({.frame = frame});
                live.accept(frame);
            }
            REQUIRE(log.finish());
        }
        rig::record::BusMeter again(can_test::ours(), kRig);
        for (const std::string& line : lines(path)) {
            const auto parsed = antiskid::can::parse_candump(line);
            again.accept(std::get<antiskid::can::CandumpLine>(parsed).frame);
        }
        CHECK(live.figures().standstill);
        for (const rig::record::FigureField& field : rig::record::kFigureFields) {
            INFO(field.key);
            CHECK(std::bit_cast<std::uint64_t>(live.figures().*field.value) == std::bit_cast<std::uint64_t>(again.figures().*field.value));
        }
        CHECK(again.faults() == live.faults());
    }
}

TEST_CASE("a full disk is said, with how much is missing; what was written stays whole", "[BRG-210]") {
    const TempDir dir;
    const auto path = dir.write("x", "").parent_path() / "bus.log";
    constexpr std::uint64_t kFrames = 10'000;
    constexpr rlim_t kBytes = 200'001;  // in the middle of a line
    std::uint64_t missing = 0;
    {
        const FileLimit limit(kBytes);
        BusLog log(path, "vcan0");
        for (std::uint64_t i = 0; i < kFrames; ++i) log.write(captured(0x123, 8, static_cast<std::int64_t>(i)));
        CHECK_FALSE(log.finish());
        missing = log.missing();
        CHECK(log.frames() == kFrames);
        CHECK_THAT(log.error(), ContainsSubstring(path.string() + ": File too large; " + std::to_string(missing) + " lines are missing"));
    }
    const auto text = lines(path);
    CHECK(text.size() + missing == kFrames);
    CHECK(text.size() == kBytes / 47);  // as many as fit, 47 bytes each
    for (const std::string& line : {text.front(), text.back()})
        CHECK(std::holds_alternative<antiskid::can::CandumpLine>(antiskid::can::parse_candump(line)));
}

TEST_CASE("Modbus samples are a table with units", "[BRG-210]") {
    const TempDir dir;
    const auto path = dir.write("x", "").parent_path() / "modbus.csv";
    rig::MeasuredValues values{};
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i) * 1.1;
    {
        rig::record::SampleLog log(std::make_unique<rig::record::AppendFile>(path));
        log.write(Time{1'436'509'053'000'713'999}, values);
        at(values, rig::Measured::longitudinal_force_N) = -2048.0;
        log.write(Time{1'436'509'053'100'000'000}, values);
        CHECK(log.rows() == 2);
        CHECK(log.finish());
    }
    const auto text = lines(path);
    REQUIRE(text.size() == 3);
    CHECK(text[0] ==
          "time_s,map_version,plc_watchdog,plc_state,applied_commit,rejected_commit,interlocks,flywheel_speed_"
          "mps,"
          "sledge_position_m,wheel_on_rim,loading_force_N,vertical_load_N,longitudinal_force_N,brake_torque_Nm,"
          "brake_temperature_C,hydraulic_pressure_Pa");
    CHECK(text[1].starts_with("1436509053.000713,0,1.1,2.2,3.3"));
    CHECK_THAT(text[2], ContainsSubstring("1436509053.100000,") && ContainsSubstring(",-2048,"));
    CHECK(std::count(text[1].begin(), text[1].end(), ',') == std::count(text[0].begin(), text[0].end(), ','));
}

TEST_CASE("a summary comes back bit for bit", "[BRG-210]") {
    const TempDir dir;
    const auto path = dir.write("x", "").parent_path() / "deep" / "summary.json";
    std::mt19937_64 random(214);
    for (int i = 0; i < 200; ++i) {
        rig::record::Summary s = some_summary();
        for (const rig::record::FigureField& field : rig::record::kFigureFields) {
            double value = std::bit_cast<double>(random());
            if (!std::isfinite(value)) value = 0.1 * i;
            s.figures.*field.value = value;
        }
        s.figures.standstill = i % 2 == 0;
        s.cumulative_energy_J = 0.1 + 0.2;
        write_summary(path, s);
        const rig::record::Summary r = rig::record::read_summary(path);
        for (const rig::record::FigureField& field : rig::record::kFigureFields) {
            CHECK(std::bit_cast<std::uint64_t>(r.figures.*field.value) == std::bit_cast<std::uint64_t>(s.figures.*field.value));
        }
        CHECK(r.cumulative_energy_J == s.cumulative_energy_J);
        CHECK(r.figures.standstill == s.figures.standstill);
        CHECK(r.campaign == s.campaign);
        CHECK(r.number == s.number);
        CHECK(r.faults == s.faults);
        CHECK(r.seed == s.seed);
        CHECK(r.frames == s.frames);
        CHECK(r.frames_dropped == s.frames_dropped);
        CHECK(r.outcome == s.outcome);
        CHECK(r.started == s.started);
        CHECK(r.scenario == s.scenario);
        CHECK(r.version == s.version);
        CHECK(r.config_hash == s.config_hash);
    }
    CHECK_THAT(rig::record::summary_table(some_summary()), ContainsSubstring("mean torque             0 N m") &&
                                                               ContainsSubstring("wheel_lost, bus_off") && ContainsSubstring("51000, 3 dropped"));
}

TEST_CASE("a summary that is none is refused by file and key", "[BRG-210]") {
    const TempDir dir;
    const auto path = dir.write("summary.json", "");
    const auto rejected = [&](const std::string& text, const std::string& why) {
        dir.write("summary.json", text);
        CHECK_THROWS_WITH(rig::record::read_summary(path), ContainsSubstring("summary.json") && ContainsSubstring(why));
    };
    CHECK_THROWS_WITH(rig::record::read_summary(path.parent_path() / "none.json"), ContainsSubstring("none.json: cannot be opened"));
    rejected("", "no JSON");
    rejected("[]", "must be an object");
    write_summary(path, some_summary());
    const std::string whole = can_test::contents(path);
    for (std::size_t cut : {std::size_t{1}, whole.size() / 2, whole.size() - 3}) rejected(whole.substr(0, cut), "no JSON");
    const auto with = [&](const char* key, const settings::Json& value) {
        auto json = settings::parse_json(whole);
        json[key] = value;
        return json.dump();
    };
    const auto without = [&](const char* key) {
        auto json = settings::parse_json(whole);
        json.erase(key);
        return json.dump();
    };
    rejected(with("format", "antiskid maneuver summary 9"), "format: must be 'antiskid maneuver summary 1'");
    rejected(with("number", -1), "number: must be an integer");
    rejected(with("number", 1.5), "number: must be an integer");
    rejected(with("number", std::numeric_limits<std::uint64_t>::max()), "number: must be at most");
    rejected(with("length_m", "long"), "length_m: must be a finite number");
    rejected(with("faults", 3), "faults: must be a list of strings");
    rejected(with("standstill", 1), "standstill: must be true or false");
    rejected(with("colour", "red"), "colour: unknown key");
    for (const char* key : {"campaign", "length_m", "standstill", "seed", "cumulative_energy_J"})
        rejected(without(key), std::string(key) + ": is missing");
}
