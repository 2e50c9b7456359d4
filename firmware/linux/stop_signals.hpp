/// SIGINT, SIGTERM and SIGHUP as something to wait for, rather than something that interrupts the loop.
#pragma once

#include <csignal>
#include <optional>

#include "firmware/control/types.hpp"

namespace antiskid::rt {

class StopSignals {
  public:
    /// Blocks the three signals in the calling thread and all that it starts later: construct before the first thread. SIGPIPE is
    /// ignored: a log reader that went away must not end the program with the valve open.
    StopSignals();

    /// Waits up to `timeout` for one of them; its number, or nothing on time-out.
    [[nodiscard]] std::optional<int> wait(control::Time timeout) const;

  private:
    sigset_t set_{};
};

}  // namespace antiskid::rt
