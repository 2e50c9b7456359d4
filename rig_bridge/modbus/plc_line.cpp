#include "rig_bridge/modbus/plc_line.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <stdexcept>

#include "rig_bridge/modbus/modbus_context.hpp"

namespace rig::modbus {
namespace {

modbus_t* new_context(const RegisterMap& map, const PlcAddress& address) {
    if (const auto* tcp = std::get_if<TcpServer>(&address)) return modbus_new_tcp(tcp->address.c_str(), tcp->port);
    return modbus_new_rtu(std::get<SerialDevice>(address).path.c_str(), map.serial.baud, map.serial.parity, 8, map.serial.stop_bits);
}

class LibmodbusLine final : public PlcLine {
  public:
    LibmodbusLine(const RegisterMap& map, const PlcAddress& address)
        : times_(map.link), serial_(std::holds_alternative<SerialDevice>(address)), context_(new_context(map, address)) {
        if (context_ == nullptr) throw std::invalid_argument(to_string(address) + ": " + modbus_error(errno));
        modbus_set_slave(context_.get(), map.unit_id);
        modbus_set_error_recovery(context_.get(), MODBUS_ERROR_RECOVERY_NONE);
        modbus_set_byte_timeout(context_.get(), 0, 0);  // the response time-out then holds for the whole answer
    }

    [[nodiscard]] int open() override {
        limit(times_.connect_timeout);
        if (modbus_connect(context_.get()) != 0) return errno;
        limit(times_.response_timeout);
        return serial_ && !wait_until_quiet() ? kNeverQuiet : 0;
    }
    void close() override { modbus_close(context_.get()); }

    [[nodiscard]] int send(std::span<const std::uint8_t> frame) override {
        if (serial_) {
            std::array<std::uint8_t, kMaxFrame> request{};  // libmodbus adds the checksum
            std::copy(frame.begin(), frame.end(), request.begin());
            return modbus_send_raw_request(context_.get(), request.data(), static_cast<int>(frame.size())) > 0 ? 0 : errno;
        }
        const auto sent = ::send(modbus_get_socket(context_.get()), frame.data(), frame.size(), MSG_NOSIGNAL);
        return sent == static_cast<ssize_t>(frame.size()) ? 0 : errno;
    }

    [[nodiscard]] int receive(std::span<std::uint8_t, kMaxFrame> frame, std::size_t& size) override {
        static_assert(kMaxFrame >= MODBUS_MAX_ADU_LENGTH);
        const int got = modbus_receive_confirmation(context_.get(), frame.data());
        if (got < 0) return errno;
        size = static_cast<std::size_t>(got);
        return 0;
    }

  private:
    void limit(std::chrono::milliseconds timeout) {
        const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(timeout);
        const auto rest = std::chrono::microseconds(timeout - seconds);
        modbus_set_response_timeout(context_.get(), static_cast<std::uint32_t>(seconds.count()), static_cast<std::uint32_t>(rest.count()));
    }

    [[nodiscard]] bool wait_until_quiet() const {
        constexpr int kPatience = 4;
        const int line = modbus_get_socket(context_.get());
        for (int i = 0; i < kPatience; ++i) {
            pollfd event{.fd = line, .events = POLLIN, .revents = 0};
            if (::poll(&event, 1, static_cast<int>(times_.response_timeout.count())) == 0) return true;
            std::array<char, 512> late{};
            static_cast<void>(!::read(line, late.data(), late.size()));
        }
        return false;
    }

    LinkTimes times_;
    bool serial_;
    ModbusContext context_;
};

}  // namespace

std::unique_ptr<PlcLine> libmodbus_line(const RegisterMap& map, const PlcAddress& address) {
    return std::make_unique<LibmodbusLine>(map, address);
}

}  // namespace rig::modbus
