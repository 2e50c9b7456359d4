/// A SocketCAN socket that only sends, and sends whatever a log may hold: both identifier lengths, data and remote frames.
#pragma once

#include <string>

#include "rig_bridge/replay/player.hpp"

namespace rig::replay {

class RawCanSender final : public FrameSender {
  public:
    /// Throws std::runtime_error naming the interface and what mends it when it is absent, down or no CAN.
    explicit RawCanSender(const std::string& interface);
    ~RawCanSender() override;
    RawCanSender(const RawCanSender&) = delete;
    RawCanSender& operator=(const RawCanSender&) = delete;

    /// Waits for room in a full transmit queue, at most kPatience.
    bool send(const LogFrame& frame) override;
    static constexpr Time kPatience{200'000'000};

  private:
    std::string interface_;
    int socket_ = -1;
};

}  // namespace rig::replay
