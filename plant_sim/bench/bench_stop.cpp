/// A whole stop in closed loop (sensors, codec rounding, real controller at 1 kHz, plant) against the same loop with the plant on
/// boost::odeint, and what one controller step costs. Table on standard output, JSON in out/bench/stop.json.

#include <fmt/core.h>
#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "firmware/control/controller.hpp"
#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/json.hpp"
#include "plant_sim/bench/closed_loop.hpp"
#include "plant_sim/bench/measure.hpp"
#include "plant_sim/bench/odeint_plant.hpp"
#include "plant_sim/scenario/stop_options.hpp"

namespace {

using antiskid::control::Controller;
using antiskid::control::Sensors;

using bench::kPeriod;
constexpr double kOdeTolerance = 1e-6;
constexpr int kRounds = 7;

plant_sim::StopInputs scenario(const char* maneuver, const char* surface) {
    plant_sim::StopOptions o;
    o.choice.maneuver = maneuver;
    o.choice.surface = surface;
    return plant_sim::load_scenario(o);
}

bench::Loop loop_of(const plant_sim::StopInputs& s) {
    return {s.controller, s.layout, s.session.plan, s.plant.drop_out_mps};
}

/// Instructions that this thread retires, where the machine can count them.
std::optional<std::uint64_t> instructions_of(const auto& run) {
    perf_event_attr attributes{};
    attributes.type = PERF_TYPE_HARDWARE;
    attributes.size = sizeof attributes;
    attributes.config = PERF_COUNT_HW_INSTRUCTIONS;
    attributes.exclude_kernel = 1;
    attributes.disabled = 1;
    const auto fd = static_cast<int>(::syscall(SYS_perf_event_open, &attributes, 0, -1, -1, 0));
    if (fd < 0) return std::nullopt;
    ::ioctl(fd, PERF_EVENT_IOC_ENABLE, 0);
    run();
    ::ioctl(fd, PERF_EVENT_IOC_DISABLE, 0);
    std::uint64_t count = 0;
    const bool read = ::read(fd, &count, sizeof count) == sizeof count;
    ::close(fd);
    return read && count > 0 ? std::optional(count) : std::nullopt;
}

/// Single steps by the clock, less what the clock itself takes.
settings::Json step_cost(const plant_sim::StopInputs& s) {
    plant::Rig rig(s.plant.rig, 1e-3, 1);
    const std::vector<Sensors> seen = bench::stop(rig, loop_of(s), true).seen;
    using Clock = std::chrono::steady_clock;
    std::vector<double> ns;
    std::vector<double> empty;
    float sum = 0.0F;
    for (int round = 0; round < kRounds; ++round) {
        Controller controller(s.controller);
        for (std::size_t i = 0; i < seen.size(); ++i) {
            const auto before = Clock::now();
            const auto middle = Clock::now();
            sum += controller.step(seen[i], kPeriod * static_cast<std::int64_t>(i)).current_mA;
            const auto after = Clock::now();
            empty.push_back(std::chrono::duration<double, std::nano>(middle - before).count());
            ns.push_back(std::chrono::duration<double, std::nano>(after - middle).count());
        }
    }
    const double clock_ns = bench::median(empty);
    settings::Json out{{"steps", ns.size()},
                       {"median_ns", bench::median(ns) - clock_ns},
                       {"p99_9_ns", bench::quantile(ns, 0.999) - clock_ns},
                       {"clock_ns", clock_ns},
                       {"checksum", sum}};
    const auto instructions = instructions_of([&] {
        Controller controller(s.controller);
        for (std::size_t i = 0; i < seen.size(); ++i) {
            sum += controller.step(seen[i], kPeriod * static_cast<std::int64_t>(i)).current_mA;
        }
    });
    if (instructions) out["instructions_per_step"] = static_cast<double>(*instructions) / static_cast<double>(seen.size());
    return out;
}

int run() {
    constexpr const char* kScenarios[][2] = {
        {"heavy", "dry_asphalt"}, {"light", "dry_cobblestone"}, {"medium_a", "wet_asphalt"}, {"medium_b", "wet_cobblestone"}, {"light", "snow"}};
    settings::Json rows = settings::Json::array();
    fmt::print("{:<10}{:<18}{:>12}{:>14}{:>14}{:>9}{:>14}\n", "maneuver", "surface", "steps", "ours (x real)", "odeint (x real)", "ratio",
               "distances (m)");
    std::vector<double> all;
    for (const auto& [maneuver, surface] : kScenarios) {
        const plant_sim::StopInputs s = scenario(maneuver, surface);
        std::vector<double> ours;
        std::vector<double> theirs;
        std::vector<double> ratios;
        bench::Stop a;
        bench::Stop b;
        for (int round = 0; round < kRounds; ++round) {
            ours.push_back(bench::processor_s_of([&] {
                plant::Rig rig(s.plant.rig, 1e-3, 1);
                a = bench::stop(rig, loop_of(s), false);
            }));
            theirs.push_back(bench::processor_s_of([&] {
                bench::OdeintRig rig(s.plant.rig, kOdeTolerance, 1);
                b = bench::stop(rig, loop_of(s), false);
            }));
            ratios.push_back(theirs.back() / ours.back());
            all.push_back(ratios.back());
        }
        const double simulated_s = static_cast<double>(a.steps) * 1e-3;
        fmt::print("{:<10}{:<18}{:>12}{:>14.0f}{:>14.0f}{:>9.2f}{:>9.1f} {:.1f}\n", maneuver, surface, a.steps, simulated_s / bench::median(ours),
                   static_cast<double>(b.steps) * 1e-3 / bench::median(theirs), bench::median(ratios), a.distance_m, b.distance_m);
        rows.push_back({{"maneuver", maneuver},
                        {"surface", surface},
                        {"steps", a.steps},
                        {"ours_times_real_time", simulated_s / bench::median(ours)},
                        {"odeint_times_real_time", static_cast<double>(b.steps) * 1e-3 / bench::median(theirs)},
                        {"ratio", bench::median(ratios)},
                        {"ours_distance_m", a.distance_m},
                        {"odeint_distance_m", b.distance_m}});
    }
    const settings::Json step = step_cost(scenario("heavy", "dry_asphalt"));
    fmt::print("median ratio {:.2f}\ncontroller.step: median {:.0f} ns, p99.9 {:.0f} ns, {}\n", bench::median(all), step["median_ns"].get<double>(),
               step["p99_9_ns"].get<double>(),
               step.contains("instructions_per_step") ? fmt::format("{:.0f} instructions", step["instructions_per_step"].get<double>())
                                                      : std::string("instructions not countable on this machine"));
    const settings::Json json{{"stops", rows}, {"median_ratio", bench::median(all)}, {"controller_step", step}};
    settings::write_file("out/bench/stop.json", json.dump(2) + "\n");
    return 0;
}

}  // namespace

int main() {
    return bench::status_of("bench_stop", run);
}
