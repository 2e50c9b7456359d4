/// Bytes over loopback TCP, without any Modbus library.
#pragma once

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "firmware/host/settings/file_descriptor.hpp"

namespace raw {

using Bytes = std::vector<std::uint8_t>;

inline sockaddr_in loopback(std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    return address;
}

inline void send(int socket, const Bytes& bytes) {
    static_cast<void>(::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL));
}

/// What is there within `timeout_ms`; empty: nothing, or the other end has closed.
inline Bytes receive(int socket, int timeout_ms) {
    pollfd event{.fd = socket, .events = POLLIN, .revents = 0};
    if (::poll(&event, 1, timeout_ms) <= 0) return {};
    std::array<std::uint8_t, 1024> bytes{};
    const auto got = ::recv(socket, bytes.data(), bytes.size(), 0);
    if (got <= 0) return {};
    return {bytes.begin(), bytes.begin() + got};
}

class Client {
  public:
    /// `from`: the address that it comes from, of 127.0.0.0/8; all of it is this machine.
    explicit Client(std::uint16_t port, const char* from = "127.0.0.1") : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        sockaddr_in own{};
        own.sin_family = AF_INET;
        if (::inet_pton(AF_INET, from, &own.sin_addr) != 1 || ::bind(socket_.get(), reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0)
            throw std::runtime_error("raw client: cannot come from there");
        const auto address = loopback(port);
        if (::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
            throw std::runtime_error("raw client: no connection");
    }
    void send(const Bytes& bytes) const { raw::send(socket_.get(), bytes); }
    [[nodiscard]] Bytes receive(int timeout_ms = 60'000) const { return raw::receive(socket_.get(), timeout_ms); }
    /// Header with transaction 0x1234 and unit 1, then the PDU; the answer's PDU, whose header must be the same.
    [[nodiscard]] Bytes ask(const Bytes& pdu) const {
        Bytes frame{0x12, 0x34, 0, 0, 0, static_cast<std::uint8_t>(pdu.size() + 1), 1};
        frame.insert(frame.end(), pdu.begin(), pdu.end());
        send(frame);
        const Bytes answer = receive();
        const bool ours = answer.size() > 7 && answer[0] == 0x12 && answer[1] == 0x34 && answer[2] == 0 && answer[3] == 0 && answer[4] == 0 &&
                          answer[5] == answer.size() - 6 && answer[6] == 1;
        if (!ours) return {};
        return {answer.begin() + 7, answer.end()};
    }

  private:
    settings::FileDescriptor socket_;
};

}  // namespace raw
