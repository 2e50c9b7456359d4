#include "plant_sim/study/run_many.hpp"

#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace study {

void run_many(const antiskid::can::Layout& layout, std::size_t count,
              const std::function<Maneuver(std::size_t number)>& make,
              const std::function<void(std::size_t number, const RunResult& result)>& done,
              const ManyOptions& options) {
    std::mutex mutex;  // of failure and done
    std::exception_ptr failure;
    std::atomic<std::size_t> next{0};
    std::atomic<bool> failed{false};
    const auto work = [&] {
        try {
            std::vector<std::size_t> begun;  // by this thread
            const auto more = [&]() -> std::optional<Maneuver> {
                if (failed.load() || (options.stop != nullptr && options.stop->load())) return std::nullopt;
                const std::size_t i = next.fetch_add(1);
                if (i >= count) return std::nullopt;
                begun.push_back(i);
                return make(i);
            };
            run_side_by_side(layout, more, [&](std::size_t i, const RunResult& result) {
                const std::scoped_lock lock(mutex);
                done(begun[i], result);
            });
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
}

}  // namespace study
