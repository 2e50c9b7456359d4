/// Numbered jobs on several threads, this one among them.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace wear {

/// Threads that this machine can run at once.
[[nodiscard]] inline unsigned all_cores() {
    return std::max(1U, std::thread::hardware_concurrency());
}

/// Numbers 0 to `count` - 1 in that order, each for whichever thread asks next; none any more once `stop` is set.
class JobNumbers {
  public:
    explicit JobNumbers(std::size_t count, const std::atomic<bool>* stop = nullptr) : count_(count), stop_(stop) {}

    [[nodiscard]] std::optional<std::size_t> next() {
        if (stop_ != nullptr && stop_->load()) return std::nullopt;
        const std::size_t number = next_.fetch_add(1);
        return number < count_ ? std::optional(number) : std::nullopt;
    }
    void end() { next_.store(count_); }

  private:
    std::size_t count_;
    const std::atomic<bool>* stop_;
    std::atomic<std::size_t> next_{0};
};

/// `work` on each of `threads` threads. The first exception ends `numbers`, and is thrown here once every thread has returned.
inline void on_threads(unsigned threads, JobNumbers& numbers, const std::function<void()>& work) {
    std::exception_ptr failure;
    std::mutex mutex;
    const auto guarded = [&] {
        try {
            work();
        } catch (...) {
            numbers.end();
            const std::scoped_lock lock(mutex);
            if (!failure) failure = std::current_exception();
        }
    };
    {
        std::vector<std::jthread> others;
        for (unsigned i = 1; i < threads; ++i) others.emplace_back(guarded);
        guarded();
    }
    if (failure) std::rethrow_exception(failure);
}

/// `job` of each number from 0 to `count` - 1, see above.
inline void run_jobs(unsigned threads, std::size_t count, const std::function<void(std::size_t)>& job, const std::atomic<bool>* stop = nullptr) {
    JobNumbers numbers(count, stop);
    on_threads(threads, numbers, [&] {
        while (const auto number = numbers.next()) job(*number);
    });
}

}  // namespace wear
