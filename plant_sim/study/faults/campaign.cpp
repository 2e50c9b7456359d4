#include "plant_sim/study/faults/campaign.hpp"

#include <exception>
#include <mutex>
#include <optional>
#include <thread>

namespace faults {

namespace {

/// Sound stops by surface and repetition, each run once.
class SoundStops {
  public:
    explicit SoundStops(const Plan& plan) : plan_(plan), known_(plan.surfaces.size() * plan.repetitions) {}

    const Sound& of(const Case& c) {
        Entry& entry = known_[c.surface * plan_.repetitions + c.repetition];
        const std::scoped_lock lock(entry.mutex);
        if (!entry.sound) entry.sound = run_sound(plan_, c);
        return *entry.sound;
    }

  private:
    struct Entry {
        std::mutex mutex;
        std::optional<Sound> sound;
    };
    const Plan& plan_;
    std::vector<Entry> known_;
};

}  // namespace

std::vector<Row> run_campaign(const Plan& plan, std::span<const std::size_t> numbers,
                              const CampaignOptions& options) {
    std::vector<std::optional<Row>> rows(numbers.size());
    SoundStops sound(plan);
    std::mutex mutex;  // of done, failure and progress
    std::size_t done = 0;
    std::exception_ptr failure;
    std::atomic<std::size_t> next{0};
    std::atomic<bool> failed{false};
    const auto work = [&] {
        try {
            while (!failed.load() && !(options.stop != nullptr && options.stop->load())) {
                const std::size_t i = next.fetch_add(1);
                if (i >= numbers.size()) return;
                const Case c = plan.at(numbers[i]);
                rows[i] = Row{c, run_one(plan, c, sound.of(c))};
                const std::scoped_lock lock(mutex);
                ++done;
                if (options.progress) options.progress(done);
            }
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
    std::vector<Row> finished;
    finished.reserve(done);
    for (std::optional<Row>& row : rows) {
        if (row) finished.push_back(*row);
    }
    return finished;
}

}  // namespace faults
