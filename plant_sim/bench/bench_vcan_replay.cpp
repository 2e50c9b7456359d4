/// bench_vcan_replay: a recorded stop played by rig-replay and by canplayer, in turn, on the same CAN interface, and recorded by
/// the same candump. How late each frame is against the log, by the kernel's stamps; the earliest frame of a round counts as on
/// time. Figures in out/bench/replay.json.

#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <thread>

#include "firmware/can/candump.hpp"
#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/bench/child.hpp"
#include "plant_sim/bench/measure.hpp"
#include "plant_sim/bench/percentiles.hpp"
#include "plant_sim/scenario/stop_options.hpp"
#include "plant_sim/study/in_process.hpp"
#include "rig_bridge/replay/log_reader.hpp"

namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using antiskid::bench::Child;
using antiskid::bench::Percentiles;
using antiskid::can::Frame;
using antiskid::can::Time;

constexpr int kRounds = 3;
constexpr const char* kInterface = "vcan0";

/// The first seconds of a landing in lockstep, its frames spread over each millisecond as a bus of 1 Mbit/s would.
std::vector<Frame> recorded_stop() {
    constexpr Time kMax{5'000'000'000};
    constexpr Time kOnBus{130'000};
    const plant_sim::StopOptions usual;
    const plant_sim::StopInputs s = plant_sim::load_scenario(usual);
    std::vector<Frame> frames;
    Time cycle{};
    Time next{};
    (void)study::run_in_process(s.controller, s.layout, s.plant.rig, s.session, study::Link::frames, {}, [&](Frame frame) {
        if (frame.received >= kMax) return;
        if (frame.received != cycle) next = cycle = frame.received;
        frame.received = next;
        next += kOnBus;
        frames.push_back(frame);
    });
    return frames;
}

std::string as_log(const std::vector<Frame>& frames) {
    std::string log;
    for (const Frame& frame : frames) {
        std::array<char, antiskid::can::kCandumpLineMax> line{};
        const std::size_t size = antiskid::can::format_candump(frame.received, kInterface, frame, line);
        log.append(line.data(), size).push_back('\n');
    }
    return log;
}

/// candump takes what is on the bus; it must have written all when it is ended.
std::vector<Frame> reception(const std::vector<std::string>& player, const fs::path& folder, std::size_t expected) {
    const fs::path log = folder / "heard.log";
    fs::remove(log);
    Child recorder({"candump", "-L", "-r", "33554432", kInterface}, log);
    std::this_thread::sleep_for(500ms);
    Child playing(player, folder / "player.says");
    if (!playing.ends_within(60s)) throw std::runtime_error(player[0] + " does not end");
    playing.expect_success();
    std::vector<Frame> frames;
    for (int turn = 0; turn < 100 && frames.size() < expected; ++turn) {
        std::this_thread::sleep_for(100ms);
        frames.clear();
        rig::replay::LogWarnings warnings(log.string(), {});
        rig::replay::LogReader reader(log, {}, warnings);
        for (rig::replay::LogFrame f; reader.next(f);) frames.push_back(f.frame);
    }
    if (frames.size() != expected)
        throw std::runtime_error(fmt::format("{}: {} frames on the bus, {} in the log", player[0], frames.size(), expected));
    return frames;
}

std::vector<std::int64_t> lateness(const std::vector<Frame>& log, const std::vector<Frame>& bus) {
    std::vector<std::int64_t> late;
    late.reserve(log.size());
    for (std::size_t i = 0; i < log.size(); ++i) {
        if (log[i].id != bus[i].id || log[i].data != bus[i].data) throw std::runtime_error("frames in another order than in the log");
        late.push_back((bus[i].received - log[i].received).count());
    }
    const std::int64_t earliest = *std::min_element(late.begin(), late.end());
    for (std::int64_t& one : late) one -= earliest;
    return late;
}

int run(const fs::path& folder) {
    const std::vector<Frame> frames = recorded_stop();
    const fs::path log = folder / "stop.log";
    settings::write_file(log, as_log(frames));
    struct Player {
        std::string name;
        std::vector<std::string> words;
        std::vector<std::int64_t> late;
    };
    std::array players{Player{"rig-replay bus", {BENCH_REPLAY, "bus", log.string(), "--can", kInterface}, {}},
                       Player{"canplayer", {"canplayer", "-I", log.string()}, {}},
                       Player{"canplayer -g 0", {"canplayer", "-g", "0", "-I", log.string()}, {}}};
    for (int round = 0; round < kRounds; ++round) {
        for (Player& player : players) {
            const auto late = lateness(frames, reception(player.words, folder, frames.size()));
            player.late.insert(player.late.end(), late.begin(), late.end());
        }
    }
    auto table = settings::TextTable::screen("late against the log, us:<36|p50:>9.1f|p99:>9.1f|p99.9:>9.1f|max:>10.1f|count:>10");
    settings::Json json{{"rounds", kRounds}};
    for (Player& player : players) {
        const Percentiles p = antiskid::bench::exact(player.late);
        table.add(player.name, p.p50_us, p.p99_us, p.p99_9_us, p.max_us, p.count);
        json[player.name] = as_json(p);
    }
    fmt::print("{}", table.text());
    settings::write_file("out/bench/replay.json", json.dump(2) + "\n");
    return 0;
}

}  // namespace

int main() {
    return bench::status_in_folder("bench_vcan_replay", run);
}
