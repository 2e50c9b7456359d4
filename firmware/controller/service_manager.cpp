#include "firmware/controller/service_manager.hpp"

#include <systemd/sd-daemon.h>

#include <chrono>
#include <utility>

namespace antiskid::controller {

ServiceManager::ServiceManager(std::function<void(const char*)> send, const host::Time watchdog) : send_(std::move(send)), every_(watchdog / 4) {}

ServiceManager ServiceManager::of_this_process() {
    std::uint64_t watchdog_us = 0;
    if (sd_watchdog_enabled(0, &watchdog_us) <= 0) watchdog_us = 0;
    // A failed notification must not end the controller: the service manager then notices the silence and acts.
    return {[](const char* state) { (void)sd_notify(0, state); }, std::chrono::microseconds{watchdog_us}};
}

void ServiceManager::update(const host::Time now, const std::uint64_t cycles) {
    if (cycles == cycles_) return;
    if (cycles_ == 0) send_("READY=1");
    if (every_ > host::Time{} && (cycles_ == 0 || now >= next_)) {
        send_("WATCHDOG=1");
        next_ = now + every_;
    }
    cycles_ = cycles;
}

void ServiceManager::stopping() {
    send_("STOPPING=1");
}

}  // namespace antiskid::controller
