/// A program that a benchmark starts; it never outlives its object.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace antiskid::bench {

class Child {
  public:
    /// `words`: program (looked up in PATH when it has no slash) and arguments. Standard output and error are
    /// appended to `log`. Throws std::system_error when it cannot be started.
    Child(const std::vector<std::string>& words, const std::filesystem::path& log);
    /// Kills what still runs.
    ~Child();
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    /// True when it has ended by itself within `time`. Asleep meanwhile.
    [[nodiscard]] bool ends_within(std::chrono::milliseconds time);
    /// Asks it to end by SIGTERM and waits for that; throws std::runtime_error when it does not.
    void stop();
    /// Its exit status, 128 + n after signal n; only after ends_within() was true or stop().
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
