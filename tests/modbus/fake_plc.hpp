/// PLCs that misbehave, over TCP and over a serial line: honest answers to what the client asks, made without any Modbus
/// library, and a hook that sends something else instead.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "rig_bridge/modbus/pseudo_terminal.hpp"
#include "tests/modbus/raw_tcp.hpp"

namespace fake {

using raw::Bytes;

/// A float32 in two registers, high word first.
inline Bytes big_float(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return {static_cast<std::uint8_t>(bits >> 24U), static_cast<std::uint8_t>(bits >> 16U), static_cast<std::uint8_t>(bits >> 8U),
            static_cast<std::uint8_t>(bits)};
}

/// The shipped map's registers. Its watchdog counts with every reading; a commit is applied when written.
class Registers {
  public:
    /// The answer's PDU to a request's PDU.
    [[nodiscard]] Bytes answer(const Bytes& pdu) {
        const unsigned first = word(pdu, 1);
        if (pdu[0] == 3 || pdu[0] == 4) {
            auto& space = pdu[0] == 4 ? inputs_ : holdings_;
            if (pdu[0] == 4) ++inputs_[1];
            const unsigned count = word(pdu, 3);
            Bytes answer{pdu[0], static_cast<std::uint8_t>(2 * count)};
            for (unsigned i = first; i < first + count; ++i) {
                answer.push_back(static_cast<std::uint8_t>(space.at(i) >> 8U));
                answer.push_back(static_cast<std::uint8_t>(space.at(i)));
            }
            return answer;
        }
        const unsigned count = word(pdu, 3);
        for (unsigned i = 0; i < count; ++i) holdings_.at(first + i) = static_cast<std::uint16_t>(word(pdu, 6 + 2 * i));
        inputs_[3] = holdings_[11];
        return {pdu.begin(), pdu.begin() + 5};
    }
    void set_speed(float value) {
        const Bytes bytes = big_float(value);
        inputs_[10] = static_cast<std::uint16_t>(word(bytes, 0));
        inputs_[11] = static_cast<std::uint16_t>(word(bytes, 2));
    }

  private:
    static unsigned word(const Bytes& bytes, std::size_t at) { return static_cast<unsigned>(bytes.at(at)) << 8U | bytes.at(at + 1); }
    std::vector<std::uint16_t> inputs_ = [] {
        std::vector<std::uint16_t> words(20);
        words[0] = 1;  // map version
        return words;
    }();
    std::vector<std::uint16_t> holdings_ = std::vector<std::uint16_t>(102);
};

struct Request {
    int line = -1;             ///< socket or terminal, to send to
    std::uint64_t number = 0;  ///< counts requests, from 0
    Bytes frame;
    Bytes honest;  ///< what a good server would answer, as a whole frame
};
/// Sends what it wants; false: the connection is closed.
using Manners = std::function<bool(const Request&)>;

inline bool honest(const Request& request) {
    raw::send(request.line, request.honest);
    return true;
}

/// One connection at a time.
class TcpPlc {
  public:
    explicit TcpPlc(Manners manners, float speed = 10.0F)
        : manners_(std::move(manners)), listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        registers_.set_speed(speed);
        auto address = raw::loopback(0);
        socklen_t size = sizeof address;
        if (::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0 || ::listen(listener_.get(), 8) != 0 ||
            ::getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0)
            throw std::runtime_error("fake PLC: no socket");
        port_ = ntohs(address.sin_port);
        thread_ = std::thread([this] { run(); });
    }
    ~TcpPlc() {
        stop_ = true;
        thread_.join();
    }
    TcpPlc(const TcpPlc&) = delete;
    TcpPlc& operator=(const TcpPlc&) = delete;

    [[nodiscard]] std::uint16_t port() const { return port_; }
    [[nodiscard]] std::uint64_t connections() const { return connections_; }
    [[nodiscard]] std::uint64_t requests() const { return requests_; }

  private:
    void run() {
        while (!stop_) {
            pollfd event{.fd = listener_.get(), .events = POLLIN, .revents = 0};
            if (::poll(&event, 1, 10) <= 0) continue;
            const settings::FileDescriptor connection(::accept(listener_.get(), nullptr, nullptr));
            ++connections_;
            serve(connection.get());
        }
    }
    /// The client sends one request and waits: what one recv() gives is one request.
    void serve(int connection) {
        while (!stop_) {
            pollfd event{.fd = connection, .events = POLLIN, .revents = 0};
            if (::poll(&event, 1, 10) <= 0) continue;
            const Bytes frame = raw::receive(connection, 0);
            if (frame.size() < 8) return;
            const Bytes pdu = registers_.answer({frame.begin() + 7, frame.end()});
            Bytes answer{frame[0], frame[1], 0, 0, 0, static_cast<std::uint8_t>(pdu.size() + 1), frame[6]};
            answer.insert(answer.end(), pdu.begin(), pdu.end());
            if (!manners_({connection, requests_++, frame, answer})) return;
        }
    }

    Manners manners_;
    Registers registers_;
    settings::FileDescriptor listener_;
    std::uint16_t port_ = 0;
    std::atomic<std::uint64_t> connections_{0}, requests_{0};
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

/// CRC-16/MODBUS; of "123456789" it is 0x4B37.
inline std::uint16_t crc16(const Bytes& bytes) {
    unsigned crc = 0xFFFF;
    for (const std::uint8_t byte : bytes) {
        crc ^= byte;
        for (int i = 0; i < 8; ++i) crc = (crc & 1U) != 0 ? crc >> 1U ^ 0xA001U : crc >> 1U;
    }
    return static_cast<std::uint16_t>(crc);
}
inline Bytes with_crc(Bytes bytes) {
    const std::uint16_t crc = crc16(bytes);
    bytes.push_back(static_cast<std::uint8_t>(crc));
    bytes.push_back(static_cast<std::uint8_t>(crc >> 8U));
    return bytes;
}

/// Answers one request after the other, in order, as a serial device does.
class RtuPlc {
  public:
    explicit RtuPlc(Manners manners, float speed = 10.0F) : manners_(std::move(manners)) {
        registers_.set_speed(speed);
        thread_ = std::thread([this] { run(); });
    }
    ~RtuPlc() {
        stop_ = true;
        thread_.join();
    }
    RtuPlc(const RtuPlc&) = delete;
    RtuPlc& operator=(const RtuPlc&) = delete;

    [[nodiscard]] const std::string& path() const { return terminal_.path(); }
    [[nodiscard]] std::uint64_t requests() const { return requests_; }

    static void write(int line, const Bytes& bytes) { static_cast<void>(!::write(line, bytes.data(), bytes.size())); }

  private:
    void run() {
        Bytes have;
        while (!stop_) {
            pollfd event{.fd = terminal_.master(), .events = POLLIN, .revents = 0};
            if (::poll(&event, 1, 10) <= 0) continue;
            std::array<std::uint8_t, 512> bytes{};
            const auto got = ::read(terminal_.master(), bytes.data(), bytes.size());
            if (got > 0) have.insert(have.end(), bytes.begin(), bytes.begin() + got);
            while (have.size() >= 8) {
                const std::size_t length = have[1] == 16 ? 9U + have[6] : 8U;
                if (have.size() < length) break;
                const Bytes frame(have.begin(), have.begin() + static_cast<std::ptrdiff_t>(length));
                have.erase(have.begin(), have.begin() + static_cast<std::ptrdiff_t>(length));
                const Bytes pdu = registers_.answer({frame.begin() + 1, frame.end() - 2});
                Bytes answer{frame[0]};
                answer.insert(answer.end(), pdu.begin(), pdu.end());
                static_cast<void>(manners_({terminal_.master(), requests_++, frame, with_crc(answer)}));
            }
        }
    }

    Manners manners_;
    Registers registers_;
    rig::modbus::PseudoTerminal terminal_;
    std::atomic<std::uint64_t> requests_{0};
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

}  // namespace fake
