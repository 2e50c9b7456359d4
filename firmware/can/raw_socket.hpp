/// A raw CAN socket while it is being set up: every refusal is a std::runtime_error that names the interface and the command that
/// mends it.
#pragma once

#include <sys/socket.h>

#include <string>
#include <utility>

namespace antiskid::can {

class RawSocket {
  public:
    enum class Calls : bool { never_wait, may_wait };  ///< those that do not say MSG_DONTWAIT
    /// Closed on exec. Refused when the interface is absent, down or no CAN, or the kernel has no CAN.
    explicit RawSocket(std::string interface, Calls calls = Calls::never_wait);
    ~RawSocket();
    RawSocket(const RawSocket&) = delete;
    RawSocket& operator=(const RawSocket&) = delete;

    /// `name` stands in the refusal: "refused NAME".
    template <typename T>
    void set_option(int level, int option, const T& value, const char* name) const {
        set_option(level, option, &value, sizeof value, name);
    }
    void set_option(int level, int option, const void* value, socklen_t size, const char* name) const;
    void bind() const;

    [[nodiscard]] int get() const { return socket_; }
    /// Now it is the caller's to close.
    [[nodiscard]] int release() { return std::exchange(socket_, -1); }

  private:
    std::string interface_;
    int socket_ = -1;
    int index_ = 0;
};

}  // namespace antiskid::can
