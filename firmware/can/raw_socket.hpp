/// Sets up a raw CAN socket. Every failure is a std::runtime_error that names the interface and the command that corrects it.
#pragma once

#include <sys/socket.h>

#include <cstdint>
#include <ctime>
#include <optional>
#include <string>
#include <utility>

namespace antiskid::can {

class RawSocket {
  public:
    enum class Calls : bool { never_wait, may_wait };  ///< whether calls without MSG_DONTWAIT may block
    /// Throws if the interface is missing, down or not CAN, or the kernel has no CAN support. The socket is closed on exec.
    explicit RawSocket(std::string interface, Calls calls = Calls::never_wait);
    ~RawSocket();
    RawSocket(const RawSocket&) = delete;
    RawSocket& operator=(const RawSocket&) = delete;

    /// `name` appears in the error text: "refused NAME".
    template <typename T>
    void set_option(int level, int option, const T& value, const char* name) const {
        set_option(level, option, &value, sizeof value, name);
    }
    void set_option(int level, int option, const void* value, socklen_t size, const char* name) const;
    void bind() const;

    [[nodiscard]] int get() const { return socket_; }
    /// Passes ownership to the caller, who must close the descriptor.
    [[nodiscard]] int release() { return std::exchange(socket_, -1); }

  private:
    std::string interface_;
    int socket_ = -1;
    int index_ = 0;
};

/// What the kernel says beside a received message.
struct BesideMessage {
    timespec stamp{};                    ///< SO_TIMESTAMPNS; 0: none
    std::optional<std::uint32_t> drops;  ///< SO_RXQ_OVFL: all messages that the socket has dropped so far, modulo 2^32
};
[[nodiscard]] BesideMessage beside(msghdr& header);

}  // namespace antiskid::can
