#include "rig_bridge/modbus/modbus_context.hpp"

#include <poll.h>
#include <sys/eventfd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <system_error>

namespace rig::modbus {

std::string modbus_error(int number) {
    switch (number) {
        case EMBXILFUN:
            return "exception 1, illegal function";
        case EMBXILADD:
            return "exception 2, illegal data address";
        case EMBXILVAL:
            return "exception 3, illegal data value";
        case EMBXSFAIL:
            return "exception 4, server failure";
        case EMBXACK:
            return "exception 5, acknowledge";
        case EMBXSBUSY:
            return "exception 6, server busy";
        case EMBXNACK:
            return "exception 7, negative acknowledge";
        case EMBXMEMPAR:
            return "exception 8, memory parity error";
        case EMBXGPATH:
            return "exception 10, gateway path unavailable";
        case EMBXGTAR:
            return "exception 11, gateway target failed to respond";
        case EMBBADCRC:
            return "answer with a wrong checksum";
        case EMBBADDATA:
            return "answer that is too long";
        case EMBBADEXC:
        case EMBUNKEXC:
            return "exception with an unknown code";
        case EMBMDATA:
            return "more registers asked for than a request holds";
        case EMBBADSLAVE:
            return "answer of another unit";
        default:
            return modbus_strerror(number);
    }
}

StopSignal::StopSignal() : event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (!event_.is_open()) throw std::system_error(errno, std::generic_category(), "eventfd");
}

void StopSignal::raise() const {
    const std::uint64_t one = 1;
    static_cast<void>(!::write(event_.get(), &one, sizeof one));  // fails only if it is set already
}

bool StopSignal::wait_for(std::chrono::nanoseconds time) const {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(time);
    const timespec timeout{.tv_sec = std::max<std::time_t>(seconds.count(), 0), .tv_nsec = std::max<long>((time - seconds).count(), 0)};
    pollfd event{.fd = event_.get(), .events = POLLIN, .revents = 0};
    return ::ppoll(&event, 1, &timeout, nullptr) > 0;
}

}  // namespace rig::modbus
