/// How far a long computation is, on standard error: a bar with the time left, or a plain line now and then where that is no terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>

namespace settings {

class Progress {
  public:
    /// `already`: maneuvers (or what `unit` names; it must outlive this) done before this run, which say nothing about its pace.
    Progress(std::int64_t planned, std::int64_t already, std::string_view unit = "maneuvers");
    /// `note` stands after the time left.
    void show(std::int64_t done, std::string_view note = {});
    ~Progress() { finish(); }
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    /// Ends the live line.
    void finish();

  private:
    using Clock = std::chrono::steady_clock;
    bool terminal_;
    std::string_view unit_;
    std::int64_t planned_;
    std::int64_t already_;
    Clock::time_point begin_;
    Clock::time_point next_;
    bool shown_ = false;
};

/// The same of a computation that says after each step how many of how many are done; `unit` must outlive it.
[[nodiscard]] std::function<void(std::size_t done, std::size_t all)> step_progress(std::string_view unit);

}  // namespace settings
