/// A program started by a benchmark; it is killed with its object.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace antiskid::bench {

class Child {
  public:
    /// `words`: program (searched for in PATH if it has no slash) and arguments. Standard output and error are appended to `log`. Throws
    /// std::system_error if it cannot be started.
    Child(const std::vector<std::string>& words, const std::filesystem::path& log);
    /// Kills the program if it still runs.
    ~Child();
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    /// Waits for at most `time`; true if it has ended by itself.
    [[nodiscard]] bool ends_within(std::chrono::milliseconds time);
    /// Sends SIGTERM and waits for the end; throws std::runtime_error if it does not come.
    void stop();
    /// Exit status, or 128 + n after signal n; only after stop(), or ends_within() that returned true.
    [[nodiscard]] int status() const { return status_; }
    /// Throws std::runtime_error unless the status is 0.
    void expect_success() const;

  private:
    [[nodiscard]] std::string name() const { return program_.filename().string(); }

    std::filesystem::path program_;
    std::filesystem::path log_;
    int pid_ = -1;
    int descriptor_ = -1;  // readable once the program has ended
    bool ended_ = false;
    int status_ = -1;
};

}  // namespace antiskid::bench
