/// SIGINT, SIGTERM and SIGHUP as a flag and a count that the loop reads, rather than something that interrupts it.
#pragma once

#include <atomic>
#include <csignal>
#include <thread>

namespace antiskid::host {

class StopSignals {
  public:
    /// Blocks the three signals in the calling thread and all that it starts later: construct before any
    /// other thread. A thread of its own waits for them, so that they are obeyed also while everybody else is
    /// held up, e.g. by a log that nobody reads. SIGPIPE is ignored: a log reader that went away must not end
    /// the program with the valve open.
    StopSignals();
    ~StopSignals();
    StopSignals(const StopSignals&) = delete;
    StopSignals& operator=(const StopSignals&) = delete;

    /// Set by the first signal; others may set it, too.
    [[nodiscard]] std::atomic<bool>& stop() { return stop_; }
    /// How many have come: the first may ask for a safe end, the second for an end at once.
    [[nodiscard]] int count() const { return count_.load(); }
    /// As if `number` came as the first; false, and nothing happens, where one has come: a second may mean an end at once.
    bool ask_first(int number) {
        int none = 0;
        if (!count_.compare_exchange_strong(none, 1)) return false;
        number_.store(number);
        stop_.store(true);
        return true;
    }
    /// The first that came; 0: none has.
    [[nodiscard]] int number() const { return number_.load(); }

  private:
    sigset_t set_{};
    std::atomic<bool> stop_{false};
    std::atomic<int> number_{0}, count_{0};
    std::atomic<bool> ending_{false};
    std::thread waiter_;
};

}  // namespace antiskid::host
