/// Shows the progress of a long computation on standard error: a bar with the time left on a terminal, otherwise an occasional line.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace settings {

class Progress {
  public:
    /// `already`: maneuvers (or what `unit` names) done before this run, not used to estimate its pace. `unit` must outlive this object.
    Progress(std::int64_t planned, std::int64_t already, std::string_view unit = "maneuvers");
    /// `note` is shown after the time left.
    void show(std::int64_t done, std::string_view note = {});
    ~Progress() { finish(); }
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    /// Ends the line on the terminal.
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

/// A bar of `width` characters: `share`, 0 to 1, of them filled.
[[nodiscard]] std::string bar(double share, std::size_t width);

/// The same as a callback for a computation that reports `done` of `all` steps; `unit` must outlive it.
[[nodiscard]] std::function<void(std::size_t done, std::size_t all)> step_progress(std::string_view unit);

}  // namespace settings
