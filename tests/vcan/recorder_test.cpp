/// The recorder on a real interface with candump beside it, and on a disk that is really full. Run by `./rig vcan --`, which gives
/// vcan0 and the right to make interfaces and to mount.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "firmware/can/candump.hpp"
#include "firmware/can/socket_can.hpp"
#include "rig_bridge/record/bus_log.hpp"
#include "rig_bridge/record/capture.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"
#include "tests/record/lines.hpp"
#include "tests/vcan/real_bus.hpp"

using namespace antiskid::can;
using can_test::TempDir;
using real_bus::Interface;
using real_bus::kPatience;
using real_bus::shell;
using record_test::lines;
using rig::record::BusLog;
using rig::record::Capture;
using rig::record::CapturedFrame;

namespace {

constexpr Time kQuiet{500'000'000};

/// A file system with so many bytes, gone at the end.
class SmallDisk {
  public:
    explicit SmallDisk(const std::string& size) : path_(dir_.write("x", "").parent_path() / "disk") {
        std::filesystem::create_directory(path_);
        shell("mount -t tmpfs -o size=" + size + " none " + path_.string());
    }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;
    ~SmallDisk() { static_cast<void>(std::system(("umount " + path_.string()).c_str())); }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    TempDir dir_;
    std::filesystem::path path_;
};

/// Until so many frames are there and the bus has been quiet for a while after them.
std::uint64_t record(Capture& capture, BusLog& log, std::uint64_t expected) {
    std::uint64_t count = 0;
    while (capture.wait(count < expected ? kPatience : kQuiet)) {
        for (const CapturedFrame& frame : capture.receive()) {
            log.write(frame);
            ++count;
        }
    }
    return count;
}

Frame numbered(std::uint32_t number) {
    Frame frame{.id = 0x110, .length = 8, .data = {}, .received = {}};
    for (std::size_t i = 0; i < 4; ++i) frame.data[i] = static_cast<std::uint8_t>(number >> (8 * i));
    return frame;
}

}  // namespace

TEST_CASE("the recorder has every frame that candump has, line for line, stamp for stamp", "[BRG-210]") {
    const TempDir dir;
    const auto folder = dir.write("x", "").parent_path();
    const auto theirs = folder / "candump.log";
    const auto ours = folder / "bus.log";
    constexpr std::uint64_t kSent = 1000 + 1000 + 300 + 4 + 500;
    // Their filter: every identifier and every error frame. They end by themselves, with the last frame.
    const auto ended = folder / "ended";
    shell("(candump -L -r 8000000 -n " + std::to_string(kSent) + " vcan0,0:0,#FFFFFFFF > " + theirs.string() + "; touch " + ended.string() +
          ") & for i in $(seq 300); do grep -qs '^ *vcan0 ' /proc/net/can/rcvlist_all && exit; sleep 0.1; done; exit 1");
    Capture capture("vcan0");
    BusLog log(ours, "vcan0");
    SocketCan own("vcan0", {});
    shell(
        "(cangen vcan0 -g 0.2 -n 1000 -e & cangen vcan0 -g 0.2 -n 1000 & cangen vcan0 -g 0.5 -n 300 -R;"
        " cansend vcan0 123#; cansend vcan0 20000004#0004000000000000; cansend vcan0 "
        "1F334455#1122334455667788;"
        " cansend vcan0 7FF#R5; wait) >/dev/null 2>&1 &");
    for (std::uint32_t i = 0; i < 500; ++i) {
        while (!own.send(numbered(i))) static_cast<void>(own.wait(Time{1'000'000}));
    }
    const std::uint64_t count = record(capture, log, kSent);
    REQUIRE(log.finish());
    shell("for i in $(seq 300); do [ -e " + ended.string() + " ] && exit; sleep 0.1; done; pkill -x candump; exit 1");
    CHECK(count == kSent);
    CHECK(capture.status().frames == count);
    CHECK(capture.status().dropped == 0);
    CHECK(capture.status().up);
    const auto expected = lines(theirs);
    CHECK(expected.size() == count);
    CHECK(lines(ours) == expected);
}

TEST_CASE("what the kernel drops before the recorder is told to the last frame", "[BRG-210]") {
    SocketCan sender("vcan0", {});
    Capture capture("vcan0", {.receive_buffer_bytes = 1});
    std::uint64_t received = 0;
    for (int round = 0; round < 3; ++round) {
        for (std::uint32_t i = 0; i < 300; ++i) REQUIRE(sender.send(numbered(i)));
        for (auto frames = capture.receive(); !frames.empty(); frames = capture.receive()) received += frames.size();
    }
    // Nothing follows the last drops, and yet they are known.
    CHECK(capture.status().dropped > 0);
    CHECK(received + capture.status().dropped == 900);
    REQUIRE(sender.send(numbered(0)));
    received += capture.receive().size();
    CHECK(received + capture.status().dropped == 901);
    const Capture roomy("vcan0");
    CHECK(roomy.receive_buffer_bytes() >= 8 << 20);
}

TEST_CASE("an interface that goes down, comes back, and vanishes", "[BRG-210]") {
    CHECK_THROWS_WITH(Capture("vcan77"), ContainsSubstring("'vcan77' does not exist"));
    CHECK_THROWS_WITH(Capture("lo"), ContainsSubstring("'lo' is no CAN interface"));
    const Interface fragile("vcan4");
    Capture capture("vcan4");
    shell("ip link set vcan4 down");
    CHECK(capture.wait(kPatience));
    CHECK(capture.receive().empty());
    CHECK_FALSE(capture.status().up);
    CHECK_FALSE(capture.status().gone);
    CHECK(capture.status().interface_error == "CAN interface 'vcan4' went down");
    shell("ip link set vcan4 up; cansend vcan4 123#11");
    REQUIRE(capture.wait(kPatience));
    REQUIRE(capture.receive().size() == 1);
    CHECK(capture.status().up);
    CHECK(capture.status().interface_error.empty());
    shell("ip link del vcan4");
    CHECK(capture.wait(kPatience));
    for (int i = 0; i < 3; ++i) CHECK(capture.receive().empty());
    CHECK_FALSE(capture.status().up);
    CHECK(capture.status().gone);
}

TEST_CASE("FD frames are counted and not recorded", "[BRG-210]") {
    const Interface fd("vcan2", "ip link set vcan2 mtu 72");
    Capture capture("vcan2");
    shell("cansend vcan2 110##3112233445566778899AABBCC; cansend vcan2 111#22; cansend vcan2 110##311");
    std::vector<CapturedFrame> all;
    while (capture.wait(kQuiet)) {
        const auto frames = capture.receive();
        all.insert(all.end(), frames.begin(), frames.end());
    }
    REQUIRE(all.size() == 1);
    CHECK(all[0].frame.id == 0x111);
    CHECK(all[0].plain());
    CHECK(capture.status().fd_frames == 2);
}

TEST_CASE("a really full disk costs the log its tail and nothing else", "[BRG-210]") {
    const SmallDisk disk("256k");
    const auto path = disk.path() / "bus.log";
    BusLog log(path, "vcan0");
    for (std::uint32_t i = 0; i < 10'000; ++i) {
        CapturedFrame frame;
        frame.frame = numbered(i);
        frame.frame.received = Time{std::int64_t{i} * 1'000'000};
        log.write(frame);
    }
    CHECK_FALSE(log.finish());
    CHECK_THAT(log.error(), ContainsSubstring("bus.log: No space left on device; "));
    const auto text = lines(path);
    CHECK(text.size() + log.missing() == 10'000);
    CHECK(text.size() > 4000);
    CHECK(std::all_of(text.begin(), text.end(), [](const std::string& line) { return std::holds_alternative<CandumpLine>(parse_candump(line)); }));
}

TEST_CASE("a really full disk leaves the ledger as it was, and with room it goes on", "[BRG-220]") {
    const SmallDisk disk("100k");
    const auto path = disk.path() / "campaign.sqlite";
    rig::record::Ledger ledger(path);
    ledger.open_campaign({.name = "a", .scenario = "s", .seed = 1, .planned = 10'000, .config_hash = "h", .version = "0", .created = "now"},
                         rig::record::IfChanged::reject);
    std::int64_t finished = 0;
    const auto one = [&] {
        rig::record::Summary summary;
        summary.campaign = "a";
        summary.number = ledger.begin(*ledger.next_number(), "now").number;
        summary.outcome = "finished";
        ledger.finish(summary);
        ++finished;
    };
    std::string error;
    try {
        while (finished < 10'000) one();
    } catch (const rig::record::LedgerError& e) {
        error = e.what();
    }
    CHECK_THAT(error, ContainsSubstring("campaign.sqlite: the disk is full; the ledger is as it was before"));
    CHECK(finished > 20);
    CHECK(ledger.finished_count() == finished);
    shell("mount -o remount,size=1m " + disk.path().string());
    ledger.mark_unfinished();
    one();
    CHECK(ledger.finished_count() == finished);
    shell(
        "/usr/bin/python3 -c 'import sqlite3,sys; r=sqlite3.connect(sys.argv[1]).execute(\"PRAGMA "
        "integrity_check\")"
        ".fetchone()[0]; sys.exit(r != \"ok\")' " +
        path.string());
}
