/// Turns SIGINT, SIGTERM and SIGHUP into a flag and a count that the loop polls.
#pragma once

#include <atomic>
#include <csignal>
#include <thread>

namespace antiskid::host {

class StopSignals {
  public:
    /// Blocks the three signals in the calling thread and in those it starts later: construct before any other thread. A separate thread waits for
    /// them, so that they act even while other threads are blocked, e.g. by a full log pipe. SIGPIPE is ignored: a closed log pipe must not end the
    /// program with the valve open.
    StopSignals();
    ~StopSignals();
    StopSignals(const StopSignals&) = delete;
    StopSignals& operator=(const StopSignals&) = delete;

    /// Set by the first signal; any thread may set it.
    [[nodiscard]] std::atomic<bool>& stop() { return stop_; }
    /// Number of signals so far. By convention the first asks for a safe end, the second for an immediate one.
    [[nodiscard]] int count() const { return count_.load(); }
    /// Acts as if signal `number` came first. False, without effect, if a signal has come: a second one would mean an immediate end.
    bool ask_first(int number) {
        int none = 0;
        if (!count_.compare_exchange_strong(none, 1)) return false;
        number_.store(number);
        stop_.store(true);
        return true;
    }
    /// The first signal that came; 0: none.
    [[nodiscard]] int number() const { return number_.load(); }
    /// Exit status of a program that a signal ended early: 130 after Ctrl-C, otherwise 1.
    [[nodiscard]] int exit_status() const { return number() == SIGINT ? 130 : 1; }

  private:
    sigset_t set_{};
    std::atomic<bool> stop_{false};
    std::atomic<int> number_{0}, count_{0};
    std::atomic<bool> ending_{false};
    std::thread waiter_;
};

}  // namespace antiskid::host
