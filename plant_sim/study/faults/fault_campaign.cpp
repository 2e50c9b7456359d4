#include "plant_sim/study/faults/fault_campaign.hpp"

#include <mutex>
#include <optional>

#include "rig_bridge/wear/on_threads.hpp"

namespace faults {

namespace {

/// Sound stops by surface and repetition, each run once.
class SoundStops {
  public:
    explicit SoundStops(const FaultPlan& plan) : plan_(plan), known_(plan.surfaces.size() * plan.repetitions) {}

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
    const FaultPlan& plan_;
    std::vector<Entry> known_;
};

}  // namespace

std::vector<Row> run_campaign(const FaultPlan& plan, std::span<const std::size_t> numbers, const CampaignOptions& options) {
    std::vector<std::optional<Row>> rows(numbers.size());
    SoundStops sound(plan);
    std::mutex mutex;
    std::size_t done = 0;
    const auto job = [&](std::size_t i) {
        const Case c = plan.at(numbers[i]);
        rows[i] = Row{c, run_one(plan, c, sound.of(c))};
        const std::scoped_lock lock(mutex);
        ++done;
        if (options.progress) options.progress(done);
    };
    wear::run_jobs(options.threads, numbers.size(), job, options.stop);
    std::vector<Row> finished;
    finished.reserve(done);
    for (std::optional<Row>& row : rows) {
        if (row) finished.push_back(*row);
    }
    return finished;
}

}  // namespace faults
