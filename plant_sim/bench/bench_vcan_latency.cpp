/// bench_vcan_latency: the real controller's wake-up and command latency on a real CAN interface. See --help.
#include <fmt/core.h>
#include <fmt/format.h>
#include <sched.h>
#include <sys/utsname.h>
#include <CLI/CLI.hpp>

#include <chrono>
#include <cstdio>
#include <exception>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "firmware/can/layout.hpp"
#include "firmware/can/roles.hpp"
#include "firmware/can/socket_can.hpp"
#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/bench/child.hpp"
#include "plant_sim/bench/command.hpp"
#include "plant_sim/bench/percentiles.hpp"

namespace antiskid::bench {

namespace {

/// How late the controller's loop wakes up, against cyclictest in its place; and how old the newest wheel frame is when the
/// command that answers it leaves, by the sensors' frame and by the timer.
///
/// In turn, each for the same time, on the same processor, at the same priority and with an interval of 1 ms:
/// antiskid-controller by its timer and by the sensors' frame, by its own histograms; and cyclictest. Each time virtual-rig puts its
/// sensor frames on the bus, by the same clock, 1,000 times a second. It brakes against the controller;
/// against cyclictest, which commands no valve, it stays at its first sample, and its frames go to a socket
/// that nobody reads.
struct WakeUpRound {
    Percentiles controller;
    Percentiles cyclictest;
    Percentiles edge_by_sensors;  ///< from the reception of the newest wheel frame to the command on its way
    Percentiles edge_by_timer;
    std::uint64_t frames_received = 0;  ///< by the controller, by its timer
    std::vector<std::string> faults;    ///< that the controller reported, e.g. overrun on a busy machine
    bool cut_short = false;             ///< virtual-rig gave up, e.g. for such a fault: measured until then
};

using namespace std::chrono_literals;

constexpr std::chrono::seconds kTimeout{30};

settings::Json read_json(const std::filesystem::path& path) {
    std::ifstream in(path);
    if (!in) throw std::runtime_error("cannot read " + path.string());
    return settings::Json::parse(in);
}

/// virtual-rig by the clock, and a socket that has seen its first frame.
class Traffic {
  public:
    Traffic(const Settings& s, const can::IdList& ids)
        : socket_(std::make_unique<can::SocketCan>(s.interface, ids.span())),
          rig_({s.virtual_rig, "--can", s.interface, "--clock", "timer", "--priority", std::to_string(s.rig_priority()), "--patience", "3600000"},
               s.log()) {
        if (!socket_->wait(kTimeout)) throw std::runtime_error("virtual-rig sent nothing; see " + s.log().string());
    }

    void close_socket() { socket_.reset(); }
    [[nodiscard]] bool ends_within(std::chrono::milliseconds time) { return rig_.ends_within(time); }
    void stop() { rig_.stop(); }

  private:
    std::unique_ptr<can::SocketCan> socket_;
    Child rig_;
};

/// The controller's report.
settings::Json run_controller(const Settings& s, const can::IdList& ids, const std::string& clock, WakeUpRound& round) {
    Traffic traffic(s, ids);
    traffic.close_socket();
    const auto report_path = std::filesystem::path(s.json).replace_extension(".controller.json");
    Child controller({s.controller, "--can", s.interface, "--clock", clock, "--priority", std::to_string(s.priority), "--cpu", std::to_string(s.cpu),
                      "--log-level", "warning", "--json", report_path},
                     s.log());
    if (traffic.ends_within(std::chrono::seconds{s.seconds})) round.cut_short = true;
    if (controller.ends_within(0ms))
        throw std::runtime_error("antiskid-controller ended with status " + std::to_string(controller.status()) + "; see " + s.log().string());
    controller.stop();
    controller.expect_success();
    traffic.stop();
    settings::Json report = read_json(report_path);
    std::filesystem::remove(report_path);
    for (const settings::Json& fault : report.at("faults")) round.faults.push_back(fault.at("name").get<std::string>());
    return report;
}

void measure_controller(const Settings& s, const can::IdList& ids, WakeUpRound& round) {
    const settings::Json by_timer = run_controller(s, ids, "timer", round);
    round.controller = from_report(by_timer, "latency");
    round.edge_by_timer = from_report(by_timer, "edge_to_command");
    round.frames_received = by_timer.at("link").at("frames_received").get<std::uint64_t>();
    round.edge_by_sensors = from_report(run_controller(s, ids, "sensors", round), "edge_to_command");
}

void measure_cyclictest(const Settings& s, const can::IdList& ids, WakeUpRound& round) {
    Traffic traffic(s, ids);
    const auto result_path = std::filesystem::path(s.json).replace_extension(".cyclictest.json");
    // The histogram reaches to 20 ms.
    std::vector<std::string> words{"cyclictest",
                                   "--quiet",
                                   "--mlockall",
                                   "--interval=1000",
                                   "--histogram=20000",
                                   "--histfile=/dev/null",
                                   "--priority=" + std::to_string(s.priority),
                                   "--affinity=" + std::to_string(s.cpu),
                                   "--duration=" + std::to_string(s.seconds),
                                   "--json=" + result_path.string()};
    if (s.priority == 0) words.emplace_back("--policy=other");
    const auto cyclictest = [&] {
        try {
            return std::make_unique<Child>(words, s.log());
        } catch (const std::system_error& error) {
            if (error.code() != std::errc::no_such_file_or_directory) throw;
            throw std::runtime_error(
                "cyclictest is not installed, so there is nothing to compare the wake-up latency with: `apt-get install rt-tests`, or ./rig setup");
        }
    }();
    if (!cyclictest->ends_within(std::chrono::seconds{s.seconds} + kTimeout))
        throw std::runtime_error("cyclictest did not end in time; see " + s.log().string());
    cyclictest->expect_success();
    if (traffic.ends_within(0ms)) throw std::runtime_error("virtual-rig ended before cyclictest; see " + s.log().string());
    traffic.stop();
    round.cyclictest = from_cyclictest(read_json(result_path));
    std::filesystem::remove(result_path);
}

/// `on_round` after each. Throws std::runtime_error when a program is missing or fails.
std::vector<WakeUpRound> measure_wake_up(const Settings& settings, const can::Layout& layout,
                                         const std::function<void(int, const WakeUpRound&)>& on_round) {
    const can::IdList ids = can::ids(layout, can::kToController);
    std::vector<WakeUpRound> rounds;
    for (int number = 1; number <= settings.rounds; ++number) {
        WakeUpRound round;
        measure_cyclictest(settings, ids, round);
        measure_controller(settings, ids, round);
        on_round(number, round);
        rounds.push_back(round);
    }
    return rounds;
}

/// What was measured: a table for the reader, JSON for programs.
struct Results {
    std::vector<WakeUpRound> wake_up;  ///< none: not measured
    std::optional<CommandLatency> command;
    std::vector<std::string> failures;  ///< why something was not measured
};

using settings::Json;

Json ratio(const Percentiles& ours, const Percentiles& theirs) {
    return {{"p50", ours.p50_us / theirs.p50_us}, {"p99", ours.p99_us / theirs.p99_us}, {"p99_9", ours.p99_9_us / theirs.p99_9_us}};
}

template <typename Round>
Percentiles middle(const std::vector<Round>& rounds, Percentiles Round::*of) {
    std::vector<Percentiles> all;
    all.reserve(rounds.size());
    for (const Round& round : rounds) all.push_back(round.*of);
    return median(all);
}

Json wake_up_json(const std::vector<WakeUpRound>& rounds) {
    Json each = Json::array();
    for (const WakeUpRound& round : rounds)
        each.push_back({{"controller", as_json(round.controller)},
                        {"cyclictest", as_json(round.cyclictest)},
                        {"edge_by_sensors", as_json(round.edge_by_sensors)},
                        {"edge_by_timer", as_json(round.edge_by_timer)},
                        {"frames_received", round.frames_received},
                        {"faults", round.faults},
                        {"cut_short", round.cut_short}});
    const Percentiles ours = middle(rounds, &WakeUpRound::controller);
    const Percentiles theirs = middle(rounds, &WakeUpRound::cyclictest);
    return {{"median",
             {{"controller", as_json(ours)},
              {"cyclictest", as_json(theirs)},
              {"ratio", ratio(ours, theirs)},
              {"edge_by_sensors", as_json(middle(rounds, &WakeUpRound::edge_by_sensors))},
              {"edge_by_timer", as_json(middle(rounds, &WakeUpRound::edge_by_timer))}}},
            {"rounds", each}};
}

Json command_json(const CommandLatency& command) {
    Json each = Json::array();
    for (const CommandRound& round : command.rounds)
        each.push_back(
            {{"controller", as_json(round.controller)}, {"ping_pong", as_json(round.ping_pong)}, {"unlike_recorded", round.unlike_recorded}});
    return {{"all",
             {{"controller", as_json(command.controller)},
              {"ping_pong", as_json(command.ping_pong)},
              {"ratio", ratio(command.controller, command.ping_pong)}}},
            {"clock_reading_us", command.clock_reading_us},
            {"rounds", each}};
}

void add_rows(std::string& text, std::string_view title, std::string_view our_name, const Percentiles& ours, std::string_view their_name,
              const Percentiles& theirs) {
    auto table = settings::TextTable::screen(fmt::format("{}:<44|p50:>9.1f|p99:>9.1f|p99.9:>9.1f|max:>9.1f|count:>10", title));
    for (const auto& [name, p] : {std::pair{our_name, ours}, std::pair{their_name, theirs}})
        table.add(fmt::format("  {}", name), p.p50_us, p.p99_us, p.p99_9_us, p.max_us, p.count);
    table.line(fmt::format("  {:<42}{:>9.2f}{:>9.2f}{:>9.2f}", "ratio", ours.p50_us / theirs.p50_us, ours.p99_us / theirs.p99_us,
                           ours.p99_9_us / theirs.p99_9_us));
    text += table.text();
}

/// Several lines, each ending in a newline.
std::string table(const Results& results) {
    std::string text;
    if (!results.wake_up.empty()) {
        add_rows(text, fmt::format("wake-up latency, us, median of {} rounds", results.wake_up.size()), "antiskid-controller by its timer",
                 middle(results.wake_up, &WakeUpRound::controller), "cyclictest", middle(results.wake_up, &WakeUpRound::cyclictest));
        add_rows(text, fmt::format("edge to command, us, median of {} rounds", results.wake_up.size()), "steps by the sensors' frame",
                 middle(results.wake_up, &WakeUpRound::edge_by_sensors), "steps by the timer", middle(results.wake_up, &WakeUpRound::edge_by_timer));
    }
    if (results.command) {
        const CommandLatency& c = *results.command;
        add_rows(text, fmt::format("command latency, us, all of {} rounds", c.rounds.size()), "SYNC to valve command", c.controller,
                 "bare SocketCAN ping-pong", c.ping_pong);
        std::uint64_t unlike = 0;
        for (const CommandRound& round : c.rounds) unlike += round.unlike_recorded;
        fmt::format_to(std::back_inserter(text), "  each contains one clock reading of {:.1f} us; answers unlike the recorded stop: {}\n",
                       c.clock_reading_us, unlike);
    }
    for (const std::string& failure : results.failures) text += "NOT MEASURED: " + failure + "\n";
    return text;
}

/// One object. All durations in us; `wake_up.median` is each figure's median over the rounds, `command.all` of
/// all rounds together; `ratio` is the controller's figure over the other's.
std::string json(const Settings& settings, const Results& results) {
    utsname system{};
    uname(&system);
    Json root{{"version", ANTISKID_VERSION},
              {"kernel", fmt::format("{} {} {}", system.sysname, system.release, system.machine)},
              {"interface", settings.interface},
              {"priority", settings.priority},
              {"cpu", settings.cpu},
              {"seconds_a_round", settings.seconds},
              {"wake_up", nullptr},
              {"command", nullptr},
              {"failures", results.failures}};
    if (!results.wake_up.empty()) root["wake_up"] = wake_up_json(results.wake_up);
    if (results.command) root["command"] = command_json(*results.command);
    return root.dump(2) + "\n";
}

}  // namespace

}  // namespace antiskid::bench
namespace {

using namespace antiskid;

/// Of those that this process may use.
int last_processor() {
    cpu_set_t set;
    CPU_ZERO(&set);
    if (sched_getaffinity(0, sizeof set, &set) != 0) return 0;
    int last = 0;
    for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
        if (CPU_ISSET(cpu, &set)) last = cpu;
    return last;
}

void add_options(CLI::App& app, bench::Settings& s) {
    app.add_option("--can", s.interface, "CAN interface that nothing else uses")->type_name("IF")->capture_default_str();
    app.add_option("--rounds", s.rounds, "of each measurement")->check(CLI::Range(1, 1000))->capture_default_str();
    app.add_option("--seconds", s.seconds, "of each wake-up measurement in a round")->check(CLI::Range(1, 6))->capture_default_str();
    app.add_option("--priority", s.priority, "SCHED_FIFO, of what is measured; 0: ordinary scheduling")
        ->check(CLI::Range(0, 99))
        ->capture_default_str();
    app.add_option("--cpu", s.cpu, "processor of what is measured")->check(CLI::Range(0, 4095))->capture_default_str();
    app.add_option("--json", s.json, "where the figures go; what the programs print goes beside it, .log")->type_name("FILE")->capture_default_str();
    app.footer(
        "Reads config/ in the working directory. On a machine without CAN: ./rig vcan -- bench_vcan_latency\n"
        "Exit status: 0 all measured; 1 something could not be, the table says what and why; 2 command line.");
}

/// A part that fails leaves the other one to be measured.
template <typename Measure>
void attempt(bench::Results& results, std::string_view what, Measure measure) {
    try {
        measure();
    } catch (const std::exception& error) {
        results.failures.push_back(fmt::format("{}: {}", what, error.what()));
        fmt::print(stderr, "bench_vcan_latency: {}\n", results.failures.back());
    }
}

bench::Results measure(const bench::Settings& s) {
    const plant_sim::StopOptions usual;
    const plant_sim::StopInputs scenario = plant_sim::load_scenario(usual);
    bench::Results results;
    attempt(results, "wake-up latency", [&] {
        results.wake_up = bench::measure_wake_up(s, scenario.layout, [&](int number, const bench::WakeUpRound& round) {
            fmt::print(stderr, "wake-up, round {} of {}: controller p50 {:.0f} us, cyclictest {:.0f} us\n", number, s.rounds, round.controller.p50_us,
                       round.cyclictest.p50_us);
            for (const std::string& fault : round.faults) fmt::print(stderr, "  the controller reported {}\n", fault);
            if (round.cut_short) fmt::print(stderr, "  virtual-rig gave up; measured until then\n");
        });
    });
    attempt(results, "command latency", [&] {
        results.command = bench::measure_command(s, bench::record_stop(scenario), [&](int number, const bench::CommandRound& round) {
            fmt::print(stderr, "command, round {} of {}: controller p50 {:.0f} us, ping-pong {:.0f} us\n", number, s.rounds, round.controller.p50_us,
                       round.ping_pong.p50_us);
        });
    });
    return results;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        bench::Settings settings;
        settings.cpu = last_processor();
        CLI::App app{
            "Latency of antiskid-controller on a CAN interface: its wake-up against cyclictest, wheel frame to command by the sensors and by the "
            "timer, SYNC to command against a bare SocketCAN ping-pong.",
            "bench_vcan_latency"};
        add_options(app, settings);
        try {
            app.parse(argc, argv);
        } catch (const CLI::ParseError& error) {
            return app.exit(error) == 0 ? 0 : 2;
        }
        if (settings.json.has_parent_path()) std::filesystem::create_directories(settings.json.parent_path());
        std::filesystem::remove(settings.log());
        const bench::Results results = measure(settings);
        fmt::print("{}", bench::table(results));
        settings::write_file(settings.json, bench::json(settings, results));
        return results.failures.empty() ? 0 : 1;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_vcan_latency: error: %s\n", error.what());
        return 1;
    }
}
