#include "firmware/host/stop_signals.hpp"

#include <pthread.h>

namespace antiskid::host {

StopSignals::StopSignals() {
    sigemptyset(&set_);
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set_, number);
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
    waiter_ = std::thread([this] {
        for (int number = 0; sigwait(&set_, &number) == 0 && !ending_.load();) {
            if (count_.load() == 0) number_.store(number);
            ++count_;
            stop_.store(true);
        }
    });
}

StopSignals::~StopSignals() {
    ending_.store(true);
    pthread_kill(waiter_.native_handle(), SIGHUP);  // ends the wait
    waiter_.join();
}

}  // namespace antiskid::host
