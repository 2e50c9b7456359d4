/// Notifies systemd (service of Type=notify) that the loop runs, and feeds its watchdog while it keeps running: sd_notify(3), sd_watchdog_enabled(3).
/// May block: not for the loop's thread. Without a service manager it does nothing.
#pragma once

#include <cstdint>
#include <functional>

#include "firmware/host/clock.hpp"

namespace antiskid::controller {

class ServiceManager {
  public:
    /// `send` receives the text for sd_notify. `watchdog`: time after which systemd kills a silent service; 0: no watchdog.
    ServiceManager(std::function<void(const char*)> send, host::Time watchdog);
    /// Configured by the environment of this process.
    [[nodiscard]] static ServiceManager of_this_process();

    /// `cycles`: of the loop since its start. Reports ready after the first cycle, then alive four times per watchdog time while cycles advance; a
    /// loop that has stopped is never reported alive.
    void update(host::Time now, std::uint64_t cycles);
    /// Call before stopping the loop deliberately.
    void stopping();

  private:
    std::function<void(const char*)> send_;
    host::Time every_;
    host::Time next_{};
    std::uint64_t cycles_ = 0;
};

}  // namespace antiskid::controller
