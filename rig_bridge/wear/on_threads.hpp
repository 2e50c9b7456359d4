/// Runs numbered jobs on several threads, including the calling one.
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

/// Number of threads that this machine can run at once.
[[nodiscard]] inline unsigned all_cores() {
    return std::max(1U, std::thread::hardware_concurrency());
}

/// Hands out the numbers 0 to `count` - 1 in order, to any thread; none after `stop` is set.
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

/// Runs `work` on each of `threads` threads. The first exception ends `numbers` and is rethrown after every thread has returned.
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

/// Runs `job` for each number from 0 to `count` - 1, as above.
inline void run_jobs(unsigned threads, std::size_t count, const std::function<void(std::size_t)>& job, const std::atomic<bool>* stop = nullptr) {
    JobNumbers numbers(count, stop);
    on_threads(threads, numbers, [&] {
        while (const auto number = numbers.next()) job(*number);
    });
}

}  // namespace wear
