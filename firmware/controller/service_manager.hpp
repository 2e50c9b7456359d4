/// What systemd is told by a service of Type=notify: that the loop runs, and, for its watchdog, that it goes on running. sd_notify(3),
/// sd_watchdog_enabled(3). For the thread that may wait; without a service manager it does nothing.
#pragma once

#include <cstdint>
#include <functional>

#include "firmware/host/clock.hpp"

namespace antiskid::controller {

class ServiceManager {
  public:
    /// `send`: takes what sd_notify does. `watchdog`: a service that is silent for so long is killed; 0: no watchdog.
    ServiceManager(std::function<void(const char*)> send, host::Time watchdog);
    /// By the environment of this process.
    [[nodiscard]] static ServiceManager of_this_process();

    /// `cycles`: of the loop, since its start. Ready with the first one; alive, four times in the watchdog's time, as long as they go on. A loop
    /// that stands is not called alive, whatever the caller does.
    void update(host::Time now, std::uint64_t cycles);
    /// The loop is about to be stopped, on purpose.
    void stopping();

  private:
    std::function<void(const char*)> send_;
    host::Time every_;
    host::Time next_{};
    std::uint64_t cycles_ = 0;
};

}  // namespace antiskid::controller
