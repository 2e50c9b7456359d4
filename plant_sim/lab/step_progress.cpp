#include "plant_sim/lab/step_progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>
#include <string>

namespace plant_sim {

void show_steps(std::size_t done, std::size_t all, const char* what) {
    constexpr std::size_t kBarWidth = 40;
    const bool terminal = ::isatty(STDERR_FILENO) == 1;
    const std::size_t steps = terminal ? kBarWidth : 10;
    if (done * steps / all == (done - 1) * steps / all) return;
    const std::size_t full = done * kBarWidth / all;
    fmt::print(stderr, "{}[{}{}] {} of {} {}{}", terminal ? "\r" : "", std::string(full, '#'),
               std::string(kBarWidth - full, '.'), done, all, what, terminal && done < all ? "" : "\n");
}

}  // namespace plant_sim
