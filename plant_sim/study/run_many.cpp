#include "plant_sim/study/run_many.hpp"

#include <mutex>
#include <optional>
#include <vector>

#include "rig_bridge/wear/on_threads.hpp"

namespace study {

void run_many(const antiskid::can::Layout& layout, std::size_t count, const std::function<Maneuver(std::size_t number)>& make,
              const std::function<void(std::size_t number, const RunResult& result)>& done, const ManyOptions& options) {
    std::mutex mutex;
    wear::JobNumbers numbers(count, options.stop);
    wear::on_threads(options.threads, numbers, [&] {
        std::vector<std::size_t> begun;  // by this thread
        const auto more = [&]() -> std::optional<Maneuver> {
            const auto i = numbers.next();
            if (!i) return std::nullopt;
            begun.push_back(*i);
            return make(*i);
        };
        run_side_by_side(layout, more, [&](std::size_t i, const RunResult& result) {
            const std::scoped_lock lock(mutex);
            done(begun[i], result);
        });
    });
}

}  // namespace study
