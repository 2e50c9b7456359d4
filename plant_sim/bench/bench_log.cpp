/// bench_log: bus logs read by our reader and by log2asc on the same file, and replayed through the controller. Figures in
/// out/bench/log.json. Processor time, the file in the page cache.

#include <fmt/core.h>
#include <sys/resource.h>
#include <zlib.h>

#include <array>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "firmware/can/candump.hpp"
#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/json.hpp"
#include "plant_sim/bench/measure.hpp"
#include "plant_sim/scenario/stop_options.hpp"
#include "plant_sim/study/in_process.hpp"
#include "rig_bridge/replay/controller_replay.hpp"

namespace {

namespace fs = std::filesystem;

constexpr int kRounds = 5;

std::string recorded_stop() {
    const plant_sim::StopOptions usual;
    const plant_sim::StopInputs s = plant_sim::load_scenario(usual);
    std::string log;
    (void)study::run_in_process(s.controller, s.layout, s.plant.rig, s.session, study::Link::frames, {}, [&](const antiskid::can::Frame& frame) {
        std::array<char, antiskid::can::kCandumpLineMax> line{};
        const std::size_t size = antiskid::can::format_candump(frame.received, "vcan0", frame, line);
        log.append(line.data(), size).push_back('\n');
    });
    return log;
}

double read_s(const fs::path& file, std::uint64_t& frames) {
    return bench::processor_s_of([&] {
        rig::replay::LogWarnings warnings(file.string(), {});
        rig::replay::LogReader log(file, {}, warnings);
        for (rig::replay::LogFrame f; log.next(f);) {
        }
        frames = log.frames();
    });
}

double children_s() {
    rusage used{};
    getrusage(RUSAGE_CHILDREN, &used);
    const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
    return seconds(used.ru_utime) + seconds(used.ru_stime);
}

double log2asc_s(const fs::path& file) {
    const double before = children_s();
    const std::string command = "log2asc -I '" + file.string() + "' -O /dev/null vcan0";
    if (std::system(command.c_str()) != 0) throw std::runtime_error(command + ": failed");  // NOLINT(concurrency-mt-unsafe)
    return children_s() - before;
}

void pack(const fs::path& from, const std::string& text, int copies) {
    gzFile file = gzopen(from.c_str(), "wb6");
    for (int i = 0; i < copies; ++i) gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
    if (gzclose(file) != Z_OK) throw std::runtime_error(from.string() + ": cannot be written");
}

int run(const fs::path& folder) {
    constexpr int kCopies = 50;
    const std::string stop = recorded_stop();
    const fs::path plain = folder / "bus.log";
    std::ofstream out(plain, std::ios::binary);
    for (int i = 0; i < kCopies; ++i) out << stop;
    out.close();
    const fs::path packed = folder / "bus.log.gz";
    pack(packed, stop, kCopies);

    std::vector<double> ours, gzip, theirs, factor;
    std::uint64_t frames = 0;
    const fs::path one = folder / "one.log";
    settings::write_file(one, stop);
    const antiskid::controller::Options usual;
    const antiskid::controller::ControllerSetup setup = antiskid::controller::load_setup(usual);
    std::uint64_t different = 0;
    std::uint64_t commands = 0;
    for (int round = 0; round < kRounds; ++round) {
        ours.push_back(read_s(plain, frames));
        gzip.push_back(read_s(packed, frames));
        theirs.push_back(log2asc_s(plain));
        rig::replay::LogWarnings warnings(one.string(), {});
        const auto report = rig::replay::replay_controller(one, {}, setup, rig::replay::ReplayClock::automatic, warnings);
        factor.push_back(report.recorded_s / report.took_s);
        commands = report.count(antiskid::can::Role::valve).compared;
        different = report.count(antiskid::can::Role::valve).different;
    }
    const auto rate = [&](const std::vector<double>& seconds) { return static_cast<double>(frames) / bench::median(seconds) * 1e-6; };
    fmt::print("{} frames, {:.0f} MB, median of {} rounds\n", frames, static_cast<double>(fs::file_size(plain)) * 1e-6, kRounds);
    fmt::print("{:<42}{:>8.2f} million frames a second\n", "rig-replay's reader, plain", rate(ours));
    fmt::print("{:<42}{:>8.2f}\n", "rig-replay's reader, gzip", rate(gzip));
    fmt::print("{:<42}{:>8.2f}\n", "log2asc, plain, to /dev/null", rate(theirs));
    fmt::print("{:<42}{:>8.2f}\n", "ratio to log2asc, plain", rate(ours) / rate(theirs));
    fmt::print("controller replay of one stop: {:.0f} times real time, {} of {} command frames differ\n", bench::median(factor), different, commands);
    const settings::Json json{{"frames", frames},
                              {"plain_frames_per_s", rate(ours) * 1e6},
                              {"gzip_frames_per_s", rate(gzip) * 1e6},
                              {"log2asc_frames_per_s", rate(theirs) * 1e6},
                              {"ratio", rate(ours) / rate(theirs)},
                              {"controller_times_real_time", bench::median(factor)},
                              {"command_frames", commands},
                              {"command_frames_different", different}};
    settings::write_file("out/bench/log.json", json.dump(2) + "\n");
    return different == 0 ? 0 : 1;
}

}  // namespace

int main() {
    return bench::status_in_folder("bench_log", run);
}
