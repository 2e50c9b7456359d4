#include "plant_sim/bench/ping_pong.hpp"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <exception>
#include <system_error>

#include "plant_sim/bench/can_socket.hpp"

namespace antiskid::bench {

namespace {

[[noreturn]] void answer(CanSocket& socket, const host::RealtimeRequest& request) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    (void)host::lock_memory();
    (void)host::enter_realtime(request);
    try {
        for (can_frame frame{}; socket.receive(frame);) {
            frame.can_id = PongProcess::kPong;
            socket.send(frame);
        }
    } catch (const std::exception&) {
        _exit(1);
    }
    _exit(1);
}

}  // namespace

PongProcess::PongProcess(const std::string& interface, const host::RealtimeRequest& request) : pid_(-1) {
    // Opened before the fork: a ping that comes before the process runs waits in the socket.
    CanSocket socket(interface, kPing);
    pid_ = fork();
    if (pid_ < 0) throw std::system_error(errno, std::generic_category(), "fork");
    if (pid_ == 0) answer(socket, request);
}

PongProcess::~PongProcess() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
}

}  // namespace antiskid::bench
