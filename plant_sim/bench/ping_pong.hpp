/// The bare other side of a SocketCAN ping-pong: a process that answers each ping with a pong.
#pragma once

#include <string>

#include <linux/can.h>

#include "firmware/host/realtime.hpp"

namespace antiskid::bench {

class PongProcess {
  public:
    static constexpr canid_t kPing = 0x7F0;
    static constexpr canid_t kPong = 0x7F1;

    /// Ready to answer when this returns. Throws when it cannot be.
    PongProcess(const std::string& interface, const host::RealtimeRequest& request);
    /// Ends it.
    ~PongProcess();
    PongProcess(const PongProcess&) = delete;
    PongProcess& operator=(const PongProcess&) = delete;

  private:
    int pid_;
};

}  // namespace antiskid::bench
