#include "rig_bridge/modbus/stop_signal.hpp"

#include <poll.h>
#include <sys/eventfd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <system_error>

namespace rig::modbus {

StopSignal::StopSignal() : event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (!event_.is_open()) throw std::system_error(errno, std::generic_category(), "eventfd");
}

void StopSignal::raise() const {
    const std::uint64_t one = 1;
    static_cast<void>(!::write(event_.get(), &one, sizeof one));  // fails only when raised already
}

bool StopSignal::wait_for(std::chrono::nanoseconds time) const {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(time);
    const timespec timeout{.tv_sec = std::max<std::time_t>(seconds.count(), 0), .tv_nsec = std::max<long>((time - seconds).count(), 0)};
    pollfd event{.fd = event_.get(), .events = POLLIN, .revents = 0};
    return ::ppoll(&event, 1, &timeout, nullptr) > 0;
}

}  // namespace rig::modbus
