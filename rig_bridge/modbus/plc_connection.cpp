#include "rig_bridge/modbus/plc_connection.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <stdexcept>
#include <utility>

namespace rig {
namespace {

modbus_t* new_context(const RegisterMap& map, const PlcAddress& address) {
    if (const auto* tcp = std::get_if<TcpServer>(&address))
        return modbus_new_tcp(tcp->address.c_str(), tcp->port);
    return modbus_new_rtu(std::get<SerialDevice>(address).path.c_str(), map.serial.baud, map.serial.parity, 8,
                          map.serial.stop_bits);
}

bool is_exception(int number) {
    return number >= EMBXILFUN && number <= EMBXGTAR;
}

}  // namespace

PlcConnection::PlcConnection(const RegisterMap& map, PlcAddress address)
    : address_(std::move(address)), times_(map.link), context_(new_context(map, address_)) {
    if (context_ == nullptr) throw std::invalid_argument(to_string(address_) + ": " + modbus_error(errno));
    modbus_set_slave(context_.get(), map.unit_id);
    modbus_set_error_recovery(context_.get(), MODBUS_ERROR_RECOVERY_NONE);
    modbus_set_byte_timeout(context_.get(), 0, 0);  // the response time-out then holds for the whole answer
}

void PlcConnection::limit(std::chrono::milliseconds timeout) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(timeout);
    const auto rest = std::chrono::microseconds(timeout - seconds);
    modbus_set_response_timeout(context_.get(), static_cast<std::uint32_t>(seconds.count()),
                                static_cast<std::uint32_t>(rest.count()));
}

LinkFailure PlcConnection::failure(const std::string& doing, std::chrono::milliseconds timeout) const {
    const int number = errno;
    const std::string what = to_string(address_) + ": " + doing + ": ";
    if (number == ETIMEDOUT)
        return {LinkFailure::Kind::timeout,
                what + "no answer within " + std::to_string(timeout.count()) + " ms"};
    return {is_exception(number) ? LinkFailure::Kind::exception : LinkFailure::Kind::other,
            what + modbus_error(number)};
}

std::optional<LinkFailure> PlcConnection::open() {
    limit(times_.connect_timeout);
    if (modbus_connect(context_.get()) != 0) {
        auto failed = failure("connect", times_.connect_timeout);
        modbus_close(context_.get());
        return failed;
    }
    open_ = true;
    limit(times_.response_timeout);
    if (std::holds_alternative<SerialDevice>(address_) && !wait_until_quiet()) {
        close();
        return LinkFailure{LinkFailure::Kind::other, to_string(address_) + ": the line is never quiet"};
    }
    return std::nullopt;
}

void PlcConnection::close() {
    modbus_close(context_.get());
    open_ = false;
}

bool PlcConnection::wait_until_quiet() const {
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

std::optional<LinkFailure> PlcConnection::judged(int done, const char* doing, std::uint16_t address,
                                                 std::size_t count) {
    if (done == static_cast<int>(count)) return std::nullopt;
    const std::string last = count > 1 ? " to " + std::to_string(address + count - 1) : "";
    auto failed = failure(std::string(doing) + " " + std::to_string(address) + last, times_.response_timeout);
    close();
    return failed;
}

std::optional<LinkFailure> PlcConnection::read_inputs(std::uint16_t address, std::span<std::uint16_t> words) {
    const int done =
        modbus_read_input_registers(context_.get(), address, static_cast<int>(words.size()), words.data());
    return judged(done, "read of input registers", address, words.size());
}

std::optional<LinkFailure> PlcConnection::read_holdings(std::uint16_t address,
                                                        std::span<std::uint16_t> words) {
    const int done =
        modbus_read_registers(context_.get(), address, static_cast<int>(words.size()), words.data());
    return judged(done, "read of holding registers", address, words.size());
}

std::optional<LinkFailure> PlcConnection::write(std::uint16_t address, std::span<const std::uint16_t> words) {
    const int done =
        modbus_write_registers(context_.get(), address, static_cast<int>(words.size()), words.data());
    return judged(done, "write of holding registers", address, words.size());
}

}  // namespace rig
