/// bench_vcan_latency: the real controller's wake-up and command latency on a real CAN interface. See --help.

#include <fmt/core.h>
#include <sched.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string_view>

#include "firmware/host/settings/atomic_file.hpp"
#include "plant_sim/bench/results.hpp"

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
        "Exit status: 0 all measured; 1 something could not be, the table says what and why; 2 command "
        "line.");
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
            "Latency of antiskid-controller on a CAN interface: its wake-up against cyclictest, wheel frame "
            "to command "
            "by the sensors and by the timer, SYNC to command against a bare SocketCAN ping-pong.",
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
