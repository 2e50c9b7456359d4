/// The least that a program on SocketCAN can do: a blocking raw socket that receives one identifier.
#pragma once

#include <linux/can.h>

#include <chrono>
#include <string>

namespace antiskid::bench {

class CanSocket {
  public:
    /// Throws std::runtime_error naming the interface when it cannot be had.
    CanSocket(const std::string& interface, canid_t wanted);
    ~CanSocket();
    CanSocket(const CanSocket&) = delete;
    CanSocket& operator=(const CanSocket&) = delete;

    /// Longest that receive() waits; at first for ever.
    void set_patience(std::chrono::milliseconds patience);
    /// Throws std::system_error when the interface does not take it.
    void send(const can_frame& frame);
    /// False when none came in time. Throws std::system_error when none can come.
    [[nodiscard]] bool receive(can_frame& frame);

  private:
    int descriptor_;
};

}  // namespace antiskid::bench
