#include "rig_bridge/record/live_file.hpp"

#include <atomic>
#include <fstream>
#include <string>
#include <vector>

#include "firmware/can/wall_clock_offset.hpp"
#include "rig_bridge/record/stamp_label.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"
#include "tests/record/lines.hpp"

using namespace std::chrono_literals;
using antiskid::can::Time;
using can_test::TempDir;
using record_test::lines;
using rig::record::LiveFile;

namespace {

template <typename Truth>
bool eventually(Truth truth) {
    for (int i = 0; i < 6000 && !truth(); ++i) std::this_thread::sleep_for(10ms);
    return truth();
}

}  // namespace

TEST_CASE("lines of a live file come to the kernel by themselves, in order", "[BRG-220]") {
    const TempDir dir;
    const auto path = dir.write("x", "").parent_path() / "deep" / "er" / "bus.log";
    LiveFile file(path);
    std::vector<std::string> sent;
    for (int i = 0; i < 20'000; ++i) {
        sent.push_back("line " + std::to_string(i));
        file.line(sent.back());
    }
    CHECK(eventually([&] { return lines(path).size() == sent.size(); }));
    file.line("last");
    sent.emplace_back("last");
    CHECK(file.finish());
    CHECK(lines(path) == sent);
    CHECK(file.lines() == sent.size());
    CHECK(file.missing() == 0);
    CHECK(file.error().empty());
    CHECK_THROWS_WITH(LiveFile(path), ContainsSubstring("bus.log: File exists"));
}

TEST_CASE("a disk that stands still holds nobody up; what the queue does not hold is counted and named", "[BRG-220]") {
    const TempDir dir;
    const auto path = dir.write("x", "").parent_path() / "bus.log";
    std::atomic<bool> stands{true}, waits{false};
    LiveFile file(path, {.queue_bytes = 1000, .before_write = [&] {
                             while (stands) {
                                 waits = true;
                                 std::this_thread::sleep_for(1ms);
                             }
                         }});
    REQUIRE(eventually([&] { return waits.load(); }));
    const std::string text(49, 'a');  // 50 bytes a line
    for (int i = 0; i < 100; ++i) file.line(text);
    CHECK(file.lines() == 100);
    CHECK(file.missing() == 80);
    CHECK_THAT(file.error(), ContainsSubstring("bus.log: the disk does not keep up, the queue was full; 80 lines"));
    stands = false;
    CHECK_FALSE(file.finish());
    CHECK(lines(path) == std::vector<std::string>(20, text));
}

TEST_CASE("the stamps of a record go on as the monotonic clock does, whoever sets the wall clock", "[BRG-200]") {
    const Time offset{1'700'000'000'000'000'000};
    rig::record::StampLabel label(offset);
    const Time noise{20'000};
    Time wall = offset;
    Time monotonic{};
    const auto came = [&](Time after, Time reading = {}) {
        monotonic += after;
        return label.of(monotonic + wall, monotonic + reading) - (monotonic + offset);
    };
    // To the nanosecond the kernel's own while nobody does.
    CHECK(came(1ms) == Time{});
    CHECK(came(1ms, noise) == Time{});
    CHECK(came(1ms, -noise) == Time{});
    for (const Time set : {Time{1s}, Time{-3h}, Time{5ms}, Time{1h}}) {
        wall += set;
        const Time off = came(1ms, noise);
        CHECK((off <= noise && off >= -noise));
        CHECK(came(1ms) == off);
    }
    CHECK(label.of(Time{5}) == offset + Time{5});
}
