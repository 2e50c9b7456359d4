#include "firmware/host/realtime.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <system_error>

namespace antiskid::host {

namespace {

std::string reason(const int error) {
    return std::generic_category().message(error);
}

// noinline: the frame must really lie below the caller's, and be gone before the loop uses the same pages.
[[gnu::noinline]] void touch_stack() {
    constexpr std::size_t kBytes = std::size_t{256} * 1024;
    unsigned char stack[kBytes];
    volatile unsigned char* const touched = stack;
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    for (std::size_t i = 0; i < kBytes; i += page) touched[i] = 0;
}

std::optional<std::string> pin(const int cpu) {
    if (cpu < 0 || cpu >= CPU_SETSIZE)
        return "processor " + std::to_string(cpu) + " does not exist: the loop is not pinned; give --cpu 0 to " +
               std::to_string(sysconf(_SC_NPROCESSORS_ONLN) - 1);
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(cpu, &set);
    const int error = pthread_setaffinity_np(pthread_self(), sizeof set, &set);
    if (error == 0) return std::nullopt;
    return "cannot pin the loop to processor " + std::to_string(cpu) + " (" + reason(error) +
           "): it may move between processors; this process may use those of `taskset -cp " + std::to_string(getpid()) +
           "`, give one of them with --cpu";
}

std::optional<std::string> raise_priority(const int priority) {
    const sched_param parameter{.sched_priority = priority};
    const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter);
    if (error == 0) return std::nullopt;
    return "no SCHED_FIFO priority " + std::to_string(priority) + " (" + reason(error) +
           "): other programs can delay the loop; run as root, or give the program the right with `setcap cap_sys_nice,cap_ipc_lock+ep "
           "antiskid-controller`, or raise RLIMIT_RTPRIO (rtprio in /etc/security/limits.conf, LimitRTPRIO= in a systemd unit) to at least " +
           std::to_string(priority);
}

}  // namespace

std::optional<std::string> lock_memory() {
    if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return std::nullopt;
    return "memory not locked (" + reason(errno) +
           "): a page fault can delay the loop; run as root, or give the program the right with `setcap cap_sys_nice,cap_ipc_lock+ep "
           "antiskid-controller`, or raise RLIMIT_MEMLOCK (`ulimit -l unlimited`, memlock in /etc/security/limits.conf, LimitMEMLOCK=infinity in a "
           "systemd unit)";
}

std::vector<std::string> enter_realtime(const RealtimeRequest& request) {
    std::vector<std::string> rejected;
    touch_stack();
    if (request.cpu)
        if (auto warning = pin(*request.cpu)) rejected.push_back(std::move(*warning));
    if (request.priority > 0)
        if (auto warning = raise_priority(request.priority)) rejected.push_back(std::move(*warning));
    return rejected;
}

}  // namespace antiskid::host
