#include "firmware/host/settings/progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

namespace settings {

namespace {

using std::chrono::milliseconds;
constexpr milliseconds kEvery{100};
constexpr milliseconds kEveryLine{2000};
constexpr std::size_t kWidth = 40;

std::string clock_text(double seconds) {
    const std::int64_t s = std::llround(seconds);
    return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60) : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

}  // namespace

Progress::Progress(std::int64_t planned, std::int64_t already, std::string_view unit)
    : terminal_(::isatty(STDERR_FILENO) == 1),
      unit_(unit),
      planned_(planned),
      already_(already),
      begin_(Clock::now()),
      next_(begin_ + (terminal_ ? milliseconds(0) : kEveryLine)) {}

void Progress::show(std::int64_t done, std::string_view note) {
    const auto now = Clock::now();
    if (now < next_ && done < planned_) return;
    next_ = now + (terminal_ ? kEvery : kEveryLine);
    const double passed_s = std::chrono::duration<double>(now - begin_).count();
    const auto run = static_cast<double>(done - already_);
    const double left_s = run > 0.0 ? passed_s / run * static_cast<double>(planned_ - done) : 0.0;
    const std::string text = fmt::format("{} of {} {}, {} left{}", done, planned_, unit_, clock_text(left_s), note);
    if (terminal_) {
        fmt::print(stderr, "\r[{}] {}\033[K", bar(static_cast<double>(done) / static_cast<double>(planned_), kWidth), text);
        (void)std::fflush(stderr);
        shown_ = true;
    } else {
        fmt::print(stderr, "{}\n", text);
    }
}

void Progress::finish() {
    if (shown_) fmt::print(stderr, "\n");
    shown_ = false;
}

std::string bar(double share, std::size_t width) {
    const auto filled = share > 0.0 ? static_cast<std::size_t>(std::min(share, 1.0) * static_cast<double>(width)) : 0;
    return std::string(filled, '#').append(width - filled, '.');
}

std::function<void(std::size_t done, std::size_t all)> step_progress(std::string_view unit) {
    return [unit, planned = std::size_t{0}, progress = std::shared_ptr<Progress>()](std::size_t done, std::size_t all) mutable {
        if (!progress || all != planned)
            progress = std::make_shared<Progress>(static_cast<std::int64_t>(all), static_cast<std::int64_t>(done) - 1, unit);
        planned = all;
        progress->show(static_cast<std::int64_t>(done));
        if (done == all) progress->finish();
    };
}

}  // namespace settings
