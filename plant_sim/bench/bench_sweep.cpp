/// The set-point study's stops, drawn from the sweep's plan by a seed, ours against the same with the plant on boost::odeint's dopri5 at
/// 1e-6: same controller, sensors, codec rounding and cores. In turns, so that what else the machine does hits both. Table on standard
/// output, JSON in out/bench/sweep.json.
///
/// Times are processor time per simulated period: ours runs to rest and measures everything that a row of the sweep says, odeint stops at
/// drop-out and measures the distance.

#include <fmt/core.h>

#include <atomic>
#include <chrono>
#include <vector>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/bench/closed_loop.hpp"
#include "plant_sim/bench/measure.hpp"
#include "plant_sim/study/in_process.hpp"
#include "plant_sim/study/run_many.hpp"
#include "plant_sim/study/sweep/run.hpp"
#include "plant_sim/study/sweep/sweep_plan.hpp"
#include "plant_sim/study/team/shared_work.hpp"
#include "rig_bridge/wear/on_threads.hpp"

namespace {

constexpr double kOdeTolerance = 1e-6;
constexpr std::size_t kStops = 120;
constexpr int kRounds = 3;

struct Times {
    double processor_s = 0.0, wall_s = 0.0;
    std::uint64_t periods = 0;

    [[nodiscard]] double ns_per_period() const { return processor_s * 1e9 / static_cast<double>(periods); }
};

/// `work` runs the stops, and returns the periods that they took.
template <typename Work>
Times timed(const Work& work) {
    Times times;
    const auto begun = std::chrono::steady_clock::now();
    times.processor_s = bench::processor_s_of([&] { times.periods = work(); });
    times.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    return times;
}

Times side_by_side(const sweep::SweepPlan& plan, const std::vector<std::size_t>& numbers, unsigned threads) {
    return timed([&] {
        std::uint64_t periods = 0;
        study::run_many(
            plan.layout, numbers.size(),
            [&](std::size_t i) {
                return study::Maneuver{plan.controller, plan.rig(numbers[i]), plan.session(numbers[i])};
            },
            [&](std::size_t, const study::RunResult& result) { periods += result.steps; }, {.threads = threads});
        return periods;
    });
}

/// One stop at a time, `stop(number)` returning its periods.
template <typename Stop>
Times one_by_one(const std::vector<std::size_t>& numbers, unsigned threads, const Stop& stop) {
    return timed([&] {
        std::atomic<std::uint64_t> periods{0};
        wear::run_jobs(threads, numbers.size(), [&](std::size_t i) { periods += stop(numbers[i]); });
        return periods.load();
    });
}

struct Engine {
    const char* name;
    std::vector<double> ns, wall_s;
    Times last;

    void add(const Times& times) {
        ns.push_back(times.ns_per_period());
        wall_s.push_back(times.wall_s);
        last = times;
    }
};

int run() {
    const sweep::SweepPlan plan = sweep::load_plan({});
    const std::vector<std::size_t> order = study::team::order_of_work(plan.stops());
    const std::vector<std::size_t> numbers(order.begin(), order.begin() + kStops);
    const unsigned threads = wear::all_cores();

    Engine ours{"ours, side by side", {}, {}, {}};
    Engine alone{"ours, one by one", {}, {}, {}};
    Engine odeint{"boost::odeint dopri5 1e-6", {}, {}, {}};
    std::vector<double> ratios;
    for (int round = 0; round < kRounds; ++round) {
        ours.add(side_by_side(plan, numbers, threads));
        odeint.add(one_by_one(numbers, threads, [&](std::size_t number) {
            const study::SessionOptions session = plan.session(number);
            bench::OdeintRig rig(plan.rig(number), kOdeTolerance, session.seed);
            return static_cast<std::uint64_t>(bench::stop(rig, {plan.controller, plan.layout, session.plan, plan.drop_out_mps}).steps);
        }));
        alone.add(one_by_one(numbers, threads, [&](std::size_t number) {
            return study::run_in_process(plan.controller, plan.layout, plan.rig(number), plan.session(number), study::Link::rounded).steps;
        }));
        ratios.push_back(odeint.ns.back() / ours.ns.back());
    }

    settings::Json rows = settings::Json::array();
    auto table = settings::TextTable::screen(":<28|periods:>12|ns per period:>16.0f|wall (s):>10.2f");
    for (const Engine* engine : {&ours, &alone, &odeint}) {
        const double ns = bench::median(engine->ns);
        const double wall_s = bench::median(engine->wall_s);
        table.add(engine->name, engine->last.periods, ns, wall_s);
        rows.push_back({{"engine", engine->name}, {"periods", engine->last.periods}, {"processor_ns_per_period", ns}, {"wall_s", wall_s}});
    }
    const double stops_4500_s = bench::median(ours.wall_s) * 4500.0 / static_cast<double>(kStops);
    fmt::print("{} of the sweep's {} stops, {} threads\n{}ratio to odeint {:.2f}; 4,500 stops at this pace {:.1f} s\n", kStops, plan.stops(), threads,
               table.text(), bench::median(ratios), stops_4500_s);
    const settings::Json json{{"stops", kStops},         {"threads", threads}, {"config_hash", plan.config_hash}, {"seed", plan.seed},
                              {"version", plan.version}, {"engines", rows},    {"ratio", bench::median(ratios)},  {"stops_4500_s", stops_4500_s}};
    settings::write_file("out/bench/sweep.json", json.dump(2) + "\n");
    return 0;
}

}  // namespace

int main() {
    return bench::status_of("bench_sweep", run);
}
