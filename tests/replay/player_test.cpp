// A clock that only sleeps, and a bus that writes down when it got what.
#include "rig_bridge/replay/player.hpp"

#include "tests/catch.hpp"
#include "tests/replay/logs.hpp"

using namespace replay_test;
using antiskid::can::Time;
using namespace std::chrono_literals;

namespace {

class SleepingClock final : public antiskid::host::Clock {
  public:
    Time now() override { return now_; }
    void sleep_until(Time deadline) override {
        CHECK(deadline - now_ <= 50ms);
        now_ = std::max(now_, deadline) + late_;
        if (stop_ != nullptr && now_ >= stop_at_) *stop_ = true;
    }
    Time now_{5s};
    Time late_{};
    std::atomic<bool>* stop_ = nullptr;
    Time stop_at_{};
};

struct Sent {
    Time at;
    std::uint32_t id;
};

class Notes final : public rig::replay::FrameSender {
  public:
    explicit Notes(SleepingClock& clock) : clock_(clock) {}
    bool send(const rig::replay::LogFrame& frame) override {
        sent.push_back({clock_.now() - Time{5s}, frame.frame.id});
        clock_.now_ += takes;
        return frame.frame.id != 0x7FF;
    }
    std::vector<Sent> sent;
    Time takes{};

  private:
    SleepingClock& clock_;
};

struct Show {
    explicit Show(const std::string& text) : file(dir.write("bus.log", text)) {}
    void run(const rig::replay::PlayOptions& options = {}) {
        rig::replay::play([&] { return std::make_unique<rig::replay::LogReader>(file, rig::replay::LogOptions{}, warnings); }, options, bus, clock,
                          stop, report);
    }
    TempDir dir;
    std::filesystem::path file;
    rig::replay::LogWarnings warnings{"bus.log", {}};
    SleepingClock clock;
    Notes bus{clock};
    std::atomic<bool> stop{false};
    rig::replay::PlayReport report;
};

const std::string kLog =
    "(100.000000) can0 111#\n(100.000500) can0 222#\n(100.200000) can0 18FF0000#00\n(101.000000) can0 "
    "111#R\n";

}  // namespace

TEST_CASE("frames go out at their times, and lateness does not add up", "[BRG-330]") {
    Show show(kLog);
    show.clock.late_ = 70us;
    show.run();
    REQUIRE(show.bus.sent.size() == 4);
    CHECK(show.bus.sent[0].at == 0us);
    CHECK(show.bus.sent[1].at == 570us);
    CHECK(show.bus.sent[2].at == 200ms + 70us);
    CHECK(show.bus.sent[3].at == 1s + 70us);
    CHECK(show.report.sent == 4);
    CHECK(show.report.late.maximum() == Time{70us});
    CHECK(show.report.late.count() == 4);
    CHECK(show.report.loops == 1);
}

TEST_CASE("a bus that takes its time makes the next frame late, not all of them", "[BRG-330]") {
    Show show(kLog);
    show.bus.takes = 600us;
    show.run();
    CHECK(show.bus.sent[1].at == 600us);
    CHECK(show.bus.sent[2].at == Time{200ms});
    CHECK(show.report.late.maximum() == Time{100us});
}

TEST_CASE("speed factor, loops and filter", "[BRG-330]") {
    Show show(kLog);
    rig::replay::PlayOptions options;
    options.speed = 4.0;
    options.loops = 3;
    options.filter.add("110:7F0");
    show.run(options);
    REQUIRE(show.bus.sent.size() == 6);
    CHECK(show.bus.sent[1].at == Time{250ms});
    CHECK(show.bus.sent[2].at == Time{250ms});
    CHECK(show.bus.sent[5].at == Time{750ms});
    CHECK(show.report.filtered == 6);
    CHECK(show.report.loops == 3);
}

TEST_CASE("time that goes backwards: at once, and on from there", "[BRG-330]") {
    Show show("(100.000000) can0 001#\n(100.100000) can0 002#\n(50.000000) can0 003#\n(50.100000) can0 004#\n");
    show.run();
    REQUIRE(show.bus.sent.size() == 4);
    CHECK(show.bus.sent[2].at == Time{100ms});
    CHECK(show.bus.sent[3].at == Time{200ms});
    CHECK(show.warnings.count(rig::replay::LogTrouble::time_backwards) == 1);
}

TEST_CASE("error frames are not sent; what the bus does not take is counted", "[BRG-330]") {
    Show show("(1.0) can0 20000040#0000000000000000\n(1.0) can0 7FF#\n(1.0) can0 123##1AA\n(1.0) can0 123#\n");
    show.run();
    CHECK(show.report.error_frames == 1);
    CHECK(show.report.sent == 1);
    CHECK(show.report.unsent == 1);
    CHECK(show.warnings.count(rig::replay::LogTrouble::fd_frame) == 1);
}

TEST_CASE("a stop ends a long pause and an endless loop", "[BRG-330]") {
    Show show("(1.0) can0 001#\n(5000.0) can0 002#\n");
    show.clock.stop_ = &show.stop;
    show.clock.stop_at_ = 12s;
    show.run();
    CHECK(show.report.stopped);
    CHECK(show.report.sent == 1);
    CHECK(show.clock.now() < 12s + 100ms);
    Show empty("nothing\n");
    rig::replay::PlayOptions endless;
    endless.loops = 0;
    empty.run(endless);
    CHECK_FALSE(empty.report.stopped);
    CHECK(empty.report.sent == 0);
}

TEST_CASE("rules of identifiers", "[BRG-300]") {
    rig::replay::IdFilter filter;
    rig::replay::LogFrame frame;
    frame.frame.id = 0x113;
    CHECK(filter.passes(frame));
    filter.add("110:7FC");
    CHECK(filter.passes(frame));
    frame.extended = true;
    CHECK_FALSE(filter.passes(frame));
    filter.add("00000113");
    CHECK(filter.passes(frame));
    frame.frame.id = 0x114;
    CHECK_FALSE(filter.passes(frame));
    for (const char* wrong : {"", "1", "1234", "800", "xyz", "110:", "110:g", "20000000"}) {
        INFO(wrong);
        CHECK_THROWS_WITH(filter.add(wrong), ContainsSubstring("like 110, 100:7F0"));
    }
}
