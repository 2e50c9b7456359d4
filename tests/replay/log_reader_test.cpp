// Logs with everything that real ones hold; the frames that must come out are known line by line.
#include "rig_bridge/replay/log_reader.hpp"

#include <fmt/format.h>

#include <random>

#include "tests/catch.hpp"
#include "tests/replay/logs.hpp"

using namespace replay_test;
using rig::replay::LogTrouble;

namespace {

/// Lines of random frames, and the frames.
std::string random_log(std::mt19937_64& random, std::size_t count, std::vector<antiskid::can::Frame>& frames) {
    std::string text;
    std::int64_t time = 1'795'000'000'000'000;
    for (std::size_t i = 0; i < count; ++i) {
        antiskid::can::Frame frame;
        frame.id = static_cast<std::uint32_t>(random() % 2048);
        frame.length = static_cast<std::uint8_t>(random() % 9);
        for (std::size_t b = 0; b < frame.length; ++b) frame.data[b] = static_cast<std::uint8_t>(random());
        time += static_cast<std::int64_t>(random() % 2000);
        frame.received = antiskid::can::Time{time * 1000};
        text += line(frame);
        frames.push_back(frame);
    }
    return text;
}

void expect(const Reading& reading, const std::vector<antiskid::can::Frame>& frames) {
    REQUIRE(reading.frames.size() == frames.size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const antiskid::can::Frame& got = reading.frames[i].frame;
        if (got.id == frames[i].id && got.length == frames[i].length && got.data == frames[i].data && got.received == frames[i].received &&
            reading.frames[i].line == i + 1)
            continue;
        FAIL("frame " << i << " differs");
    }
    CHECK(reading.said.empty());
}

}  // namespace

TEST_CASE("a log in memory is read as its file is", "[BRG-300]") {
    const TempDir dir;
    std::mt19937_64 random(3002);
    std::vector<antiskid::can::Frame> frames;
    const std::string text = random_log(random, 5'000, frames);
    for (const std::string& log : {text, text.substr(0, text.size() - 3), "nothing\n" + text, std::string(9000, '\0') + text, std::string()}) {
        rig::replay::LogWarnings warnings("bus.log", {});
        rig::replay::LogReader reader(rig::replay::LogText{log}, {}, warnings);
        const Reading file(dir.write("bus.log", log));
        std::size_t read = 0;
        for (rig::replay::LogFrame frame; reader.next(frame); ++read) {
            REQUIRE(read < file.frames.size());
            CHECK(frame.line == file.frames[read].line);
            CHECK(frame.frame.data == file.frames[read].frame.data);
        }
        CHECK(read == file.frames.size());
        CHECK(warnings.summary() == file.warnings.summary());
    }
}

TEST_CASE("a log gives its frames in order, plain and gzip alike, over many blocks", "[BRG-300]") {
    const TempDir dir;
    std::mt19937_64 random(3001);
    std::vector<antiskid::can::Frame> frames;
    const std::string text = random_log(random, 50'000, frames);
    REQUIRE(text.size() > std::size_t{5} * 256 * 1024);
    expect(Reading(dir.write("plain.log", text)), frames);
    expect(Reading(write_gzip(dir.write("x", "").parent_path() / "a.log.gz", text)), frames);
    // The name does not matter, and members of gzip files may follow each other.
    const auto half = text.find('\n', text.size() / 2) + 1;
    const auto one = write_gzip(dir.write("1", "").parent_path() / "1.gz", text.substr(0, half));
    const auto two = write_gzip(dir.write("2", "").parent_path() / "2.gz", text.substr(half));
    expect(Reading(dir.write("both.log", can_test::contents(one) + can_test::contents(two))), frames);
}

TEST_CASE("whatever a log may hold is named with its line", "[BRG-300]") {
    const TempDir dir;
    const std::string good = "(1000000000.000100) vcan0 110#0011\n";
    const auto names = [&](const std::string& bad, LogTrouble trouble, const std::string& words, std::size_t frames = 2) {
        INFO(bad.substr(0, 80));
        const Reading reading(dir.write("bus.log", good + bad + good));
        CHECK(reading.frames.size() == frames);
        CHECK(reading.warnings.count(trouble) == 1);
        REQUIRE(reading.said.size() == 1);
        CHECK(reading.said[0].starts_with(fmt::format("bus.log:2: {}: ", rig::replay::name(trouble))));
        CHECK_THAT(reading.said[0], ContainsSubstring(words));
    };
    names("(1000000000.000100) vcan0 110#00\xFF\n", LogTrouble::not_text, "\\xFF");
    names("\xC3\x28\xA0\n", LogTrouble::not_text, "\\xC3");
    names(std::string("(1000000000.000100) vcan0 1\0 0#00\n", 34), LogTrouble::not_text, "\\x00");
    names("(1000000000.000100) vc\x1B[2Jan0 110#00\n", LogTrouble::not_text, "\\x1B");
    names("(1000000000.0001\n", LogTrouble::malformed_line, "column");
    names("(1000000000.000100) vcan0 110#001\n", LogTrouble::malformed_line, "two hexadecimal digits");
    names("\n", LogTrouble::malformed_line, "expected the time");
    names("(1000000000.000100) vcan0 110##1001122\n", LogTrouble::fd_frame, "110##");
    names("(1000000000.000100) can1 110#0011\n", LogTrouble::other_interface, "can1; read is vcan0");
    names("(0999999999.000100) vcan0 110#0011\n", LogTrouble::time_backwards, "1.000000 s", 3);
    names("(1000000000.000100) vcan0 20000040#0000000000000000\n", LogTrouble::error_frame, "040", 3);
    names("(1000000000.000100) vcan0 18FF0000#00\n", LogTrouble::extended_frame, "18FF0000", 3);
    names("(1000000000.000100) vcan0 110#R\n", LogTrouble::remote_frame, "110", 3);
    names(std::string(5'000, 'x') + "\n", LogTrouble::long_line, "xxx");
    names(std::string(3'000'000, '0') + "\n", LogTrouble::long_line, "000");
}

TEST_CASE("with a layout every identifier that it lacks is said once and counted always", "[BRG-300]") {
    const TempDir dir;
    std::string text;
    for (int i = 0; i < 1000; ++i) text += "(1.000000) vcan0 555#00\n(1.000000) vcan0 110#0011\n";
    text += "(1.000000) vcan0 556#00\n(1.000000) vcan0 18FF0000#00\n";
    rig::replay::LogOptions options;
    options.layout = &can_test::ours();
    const Reading reading(dir.write("bus.log", text), options);
    CHECK(reading.frames.size() == 1000);
    CHECK(reading.warnings.count(LogTrouble::foreign_id) == 1001);
    CHECK(reading.warnings.count(LogTrouble::extended_frame) == 1);
    CHECK(reading.said.size() == 3);
    CHECK(reading.warnings.summary() == "extended_frame 1, foreign_id 1001");
}

TEST_CASE("of each kind few are said and all are counted", "[BRG-300]") {
    const TempDir dir;
    std::string text;
    for (int i = 0; i < 500; ++i) text += "nonsense\n(1.0) can0 123##0\n";
    const Reading reading(dir.write("bus.log", text));
    CHECK(reading.frames.empty());
    CHECK(reading.warnings.count(LogTrouble::malformed_line) == 500);
    CHECK(reading.warnings.count(LogTrouble::fd_frame) == 500);
    CHECK(reading.said.size() == 6);
    CHECK_THAT(reading.said.back(), ContainsSubstring("only counted"));
}

TEST_CASE("a log that is cut off gives all before the cut and says so", "[BRG-300]") {
    const TempDir dir;
    std::mt19937_64 random(302);
    std::vector<antiskid::can::Frame> frames;
    const std::string text = random_log(random, 20'000, frames);
    const Reading plain(dir.write("bus.log", text.substr(0, text.size() - 1)));
    CHECK(plain.frames.size() == 20'000);
    CHECK(plain.warnings.count(LogTrouble::unfinished_line) == 1);
    const Reading torn(dir.write("bus.log", text.substr(0, text.size() - 30)));
    CHECK(torn.frames.size() == 19'999);
    CHECK(torn.said.size() == 1);
    std::string hole = text;  // two sectors that a power cut took
    hole.replace(8192, 8192, 8192, '\0');
    const Reading holed(dir.write("bus.log", hole));
    CHECK(holed.warnings.damage() == std::vector<std::string>{"log_damaged: long_line 1"});
    const std::string packed = can_test::contents(write_gzip(dir.write("z", "").parent_path() / "a.gz", text));
    const Reading cut(dir.write("cut.gz", packed.substr(0, packed.size() / 2)));
    CHECK(cut.warnings.count(LogTrouble::damaged_file) == 1);
    CHECK(cut.frames.size() > 5'000);
    CHECK(cut.frames.size() < 15'000);
    std::string corrupt = packed;
    for (std::size_t i = packed.size() / 2; i < packed.size() / 2 + 200; ++i) corrupt[i] = 'x';
    const Reading broken(dir.write("broken.gz", corrupt));
    CHECK(broken.warnings.count(LogTrouble::damaged_file) == 1);
    CHECK(broken.frames.size() > 5'000);
}

TEST_CASE("another interface is read where it is asked for", "[BRG-300]") {
    const TempDir dir;
    const auto file = dir.write("bus.log", "(1.0) can0 111#\n(1.1) can1 222#\n(1.2) can0 333#\n");
    rig::replay::LogOptions options;
    options.interface = "can1";
    const Reading reading(file, options);
    REQUIRE(reading.frames.size() == 1);
    CHECK(reading.frames[0].frame.id == 0x222);
    CHECK(reading.warnings.count(LogTrouble::other_interface) == 2);
}

TEST_CASE("a log that is not there is named with the reason", "[BRG-300]") {
    rig::replay::LogWarnings warnings("x", {});
    CHECK_THROWS_WITH(rig::replay::LogReader("/nowhere/bus.log", {}, warnings), ContainsSubstring("/nowhere/bus.log: cannot be read: No such file"));
    CHECK_THROWS_WITH(rig::replay::LogReader("/tmp", {}, warnings), ContainsSubstring("is a directory"));
}

TEST_CASE("mutated logs: every line is a frame or a counted warning", "[BRG-300]") {
    const TempDir dir;
    std::mt19937_64 random(303);
    constexpr std::array kOfAll{LogTrouble::malformed_line, LogTrouble::long_line, LogTrouble::not_text, LogTrouble::fd_frame,
                                LogTrouble::other_interface};
    const std::string alphabet = std::string("0123456789ABCDEFabcdefRT#().\r\n \t") + '\0' + "\xFF\x80xvcan";
    for (int round = 0; round < 300; ++round) {
        std::vector<antiskid::can::Frame> frames;
        std::string text = random_log(random, 200, frames);
        const std::size_t changes = 1 + random() % 200;
        for (std::size_t i = 0; i < changes; ++i) {
            const std::size_t at = random() % text.size();
            const char with = random() % 4 == 0 ? static_cast<char>(random()) : alphabet[random() % alphabet.size()];
            switch (random() % 4) {
                case 0:
                    text.insert(at, 1, with);
                    break;
                case 1:
                    text.erase(at, 1 + random() % 40);
                    break;
                default:
                    text[at] = with;
            }
            if (text.empty()) text.push_back('\n');
        }
        if (round % 10 == 0) text.insert(random() % text.size(), 9'000, 'z');
        const auto file = round % 2 == 0 ? dir.write("bus.log", text) : write_gzip(dir.write("x", "").parent_path() / "m.gz", text);
        const Reading reading(file);
        std::uint64_t dropped = 0;
        for (const LogTrouble trouble : kOfAll) dropped += reading.warnings.count(trouble);
        const auto lines = static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n')) + (text.back() == '\n' ? 0U : 1U);
        INFO("round " << round << ": " << reading.warnings.summary());
        REQUIRE(reading.frames.size() + dropped == lines);
        for (const std::string& said : reading.said) REQUIRE(std::all_of(said.begin(), said.end(), [](char c) { return c >= ' ' && c <= '~'; }));
    }
}

TEST_CASE("the fast form of a line and the general one agree on every mutation", "[BRG-300]") {
    using antiskid::can::CandumpLine;
    std::mt19937_64 random(304);
    std::uint64_t both = 0;
    for (int round = 0; round < 200'000; ++round) {
        std::vector<antiskid::can::Frame> frames;
        std::string text = random_log(random, 1, frames);
        text.pop_back();
        if (random() % 2 == 0) text[random() % text.size()] = "0123456789ABCDEFabcdefg#(). x/:@G`"[random() % 34];
        if (random() % 8 == 0) text.erase(random() % text.size(), 1);
        // A carriage return is accepted by the general form only.
        const auto fast = antiskid::can::parse_candump(text);
        const std::string with_return = text + "\r";
        const auto general = antiskid::can::parse_candump(with_return);
        INFO(text);
        REQUIRE(fast.index() == general.index());
        const auto* a = std::get_if<CandumpLine>(&fast);
        if (a == nullptr) continue;
        const auto* b = std::get_if<CandumpLine>(&general);
        REQUIRE((a->time == b->time && a->interface == b->interface && a->frame.id == b->frame.id && a->frame.length == b->frame.length &&
                 a->frame.data == b->frame.data && a->frame.received == b->frame.received && a->extended == b->extended && a->remote == b->remote &&
                 a->error == b->error));
        ++both;
    }
    CHECK(both > 100'000);
}
