#include "firmware/host/stop_signals.hpp"

#include <pthread.h>

namespace antiskid::rt {

StopSignals::StopSignals() {
    sigemptyset(&set_);
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set_, number);
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
    waiter_ = std::thread([this] {
        int number = 0;
        sigwait(&set_, &number);
        number_.store(number);
        stop_.store(true);
    });
}

StopSignals::~StopSignals() {
    pthread_kill(waiter_.native_handle(), SIGHUP);  // ends the wait; without effect where it has ended
    waiter_.join();
}

}  // namespace antiskid::rt
