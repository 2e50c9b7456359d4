#include "plant_sim/study/sweep/run.hpp"

#include <algorithm>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "plant_sim/study/in_process.hpp"
#include "plant_sim/study/side_by_side.hpp"

namespace sweep {

Row run_one(const Plan& plan, std::size_t number) {
    const study::RunResult result = study::run_in_process(plan.controller, plan.layout, plan.rig(number),
                                                          plan.session(number), study::Link::rounded);
    return {.stop = plan.stop(number), .figures = result.figures, .faults = result.faults};
}

std::vector<Row> run(const Plan& plan, std::span<const std::size_t> numbers, const RunOptions& options) {
    std::vector<Row> rows;
    rows.reserve(numbers.size());
    std::mutex mutex;  // of rows, failure and on_row
    std::exception_ptr failure;
    std::atomic<std::size_t> next{0};
    std::atomic<bool> failed{false};
    const auto work = [&] {
        try {
            std::vector<std::size_t> begun;  // by this thread
            const auto more = [&]() -> std::optional<study::Maneuver> {
                if (failed.load() || (options.stop != nullptr && options.stop->load())) return std::nullopt;
                const std::size_t i = next.fetch_add(1);
                if (i >= numbers.size()) return std::nullopt;
                begun.push_back(numbers[i]);
                return study::Maneuver{plan.controller, plan.rig(numbers[i]), plan.session(numbers[i])};
            };
            const auto done = [&](std::size_t i, const study::RunResult& result) {
                Row row{.stop = plan.stop(begun[i]), .figures = result.figures, .faults = result.faults};
                const std::scoped_lock lock(mutex);
                if (options.on_row) options.on_row(row);
                rows.push_back(std::move(row));
            };
            study::run_side_by_side(plan.layout, more, done);
        } catch (...) {
            const std::scoped_lock lock(mutex);
            if (!failure) failure = std::current_exception();
            failed.store(true);
        }
    };
    {
        std::vector<std::jthread> threads;
        for (unsigned i = 1; i < options.threads; ++i) threads.emplace_back(work);
        work();
    }
    if (failure) std::rethrow_exception(failure);
    std::sort(rows.begin(), rows.end(),
              [](const Row& a, const Row& b) { return a.stop.number < b.stop.number; });
    return rows;
}

}  // namespace sweep
