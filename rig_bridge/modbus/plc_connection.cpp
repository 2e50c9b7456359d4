#include "rig_bridge/modbus/plc_connection.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <stdexcept>
#include <utility>

#include "rig_bridge/modbus/confirmation.hpp"

namespace rig::modbus {
namespace {

modbus_t* new_context(const RegisterMap& map, const PlcAddress& address) {
    if (const auto* tcp = std::get_if<TcpServer>(&address)) return modbus_new_tcp(tcp->address.c_str(), tcp->port);
    return modbus_new_rtu(std::get<SerialDevice>(address).path.c_str(), map.serial.baud, map.serial.parity, 8, map.serial.stop_bits);
}

std::string registers(std::uint16_t address, std::size_t count) {
    return std::to_string(address) + (count > 1 ? " to " + std::to_string(address + count - 1) : "");
}

std::string exception_text(unsigned code) {
    constexpr unsigned kLast = 11;
    return code <= kLast ? modbus_error(MODBUS_ENOBASE + static_cast<int>(code))
                         : "exception " + std::to_string(code) + ", which no specification has";
}

}  // namespace

PlcConnection::PlcConnection(const RegisterMap& map, PlcAddress address)
    : address_(std::move(address)), times_(map.link), unit_(map.unit_id), context_(new_context(map, address_)) {
    if (context_ == nullptr) throw std::invalid_argument(to_string(address_) + ": " + modbus_error(errno));
    modbus_set_slave(context_.get(), unit_);
    modbus_set_error_recovery(context_.get(), MODBUS_ERROR_RECOVERY_NONE);
    modbus_set_byte_timeout(context_.get(), 0, 0);  // the response time-out then holds for the whole answer
}

void PlcConnection::limit(std::chrono::milliseconds timeout) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(timeout);
    const auto rest = std::chrono::microseconds(timeout - seconds);
    modbus_set_response_timeout(context_.get(), static_cast<std::uint32_t>(seconds.count()), static_cast<std::uint32_t>(rest.count()));
}

LinkFailure PlcConnection::failure(const std::string& doing, std::chrono::milliseconds timeout) const {
    const int number = errno;
    const std::string what = to_string(address_) + ": " + doing + ": ";
    if (number == ETIMEDOUT) return {LinkFailure::Kind::timeout, what + "no answer within " + std::to_string(timeout.count()) + " ms"};
    return {LinkFailure::Kind::other, what + modbus_error(number)};
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
    if (serial() && !wait_until_quiet()) {
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

bool PlcConnection::send(std::span<const std::uint8_t> pdu) {
    if (serial()) {
        std::vector<std::uint8_t> request{unit_};
        request.insert(request.end(), pdu.begin(), pdu.end());
        return modbus_send_raw_request(context_.get(), request.data(), static_cast<int>(request.size())) > 0;
    }
    const auto frame = tcp_request(++transaction_, unit_, pdu);
    const auto sent = ::send(modbus_get_socket(context_.get()), frame.data(), frame.size(), MSG_NOSIGNAL);
    return sent == static_cast<ssize_t>(frame.size());
}

std::string PlcConnection::frame_fault(std::span<const std::uint8_t> frame) const {
    if (!serial()) return tcp_header_fault(transaction_, unit_, frame);
    return frame[0] == unit_ ? "" : "answer of another unit: " + std::to_string(frame[0]);
}

std::optional<LinkFailure> PlcConnection::asked(const std::string& doing, std::span<const std::uint8_t> pdu) {
    if (!send(pdu)) return failure(doing, times_.response_timeout);
    std::array<std::uint8_t, MODBUS_MAX_ADU_LENGTH> bytes{};
    const int got = modbus_receive_confirmation(context_.get(), bytes.data());
    if (got < 0) return failure(doing, times_.response_timeout);
    const auto frame = std::span(bytes).first(static_cast<std::size_t>(got));
    const std::string what = to_string(address_) + ": " + doing + ": ";
    if (const auto fault = frame_fault(frame); !fault.empty()) return LinkFailure{LinkFailure::Kind::other, what + fault};
    const std::size_t header = serial() ? 1 : 7;
    const std::size_t checksum = serial() ? 2 : 0;
    const auto answer = frame.subspan(header, frame.size() - header - checksum);
    if (const unsigned code = exception_of(pdu, answer); code != 0) return LinkFailure{LinkFailure::Kind::exception, what + exception_text(code)};
    if (const auto fault = answer_fault(pdu, answer); !fault.empty()) return LinkFailure{LinkFailure::Kind::other, what + fault};
    answer_.assign(answer.begin(), answer.end());
    return std::nullopt;
}

std::optional<LinkFailure> PlcConnection::ask(const std::string& doing, std::span<const std::uint8_t> pdu) {
    auto failed = asked(doing, pdu);
    if (failed) close();
    return failed;
}

std::optional<LinkFailure> PlcConnection::read(std::uint8_t function, const std::string& doing, std::uint16_t address,
                                               std::span<std::uint16_t> words) {
    const auto request = read_request(function, address, static_cast<std::uint16_t>(words.size()));
    auto failed = ask(doing + registers(address, words.size()), request);
    if (failed) return failed;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const unsigned high = answer_[2 + 2 * i];
        words[i] = static_cast<std::uint16_t>(high << 8U | answer_[3 + 2 * i]);
    }
    return std::nullopt;
}

std::optional<LinkFailure> PlcConnection::read_inputs(std::uint16_t address, std::span<std::uint16_t> words) {
    return read(MODBUS_FC_READ_INPUT_REGISTERS, "read of input registers ", address, words);
}

std::optional<LinkFailure> PlcConnection::read_holdings(std::uint16_t address, std::span<std::uint16_t> words) {
    return read(MODBUS_FC_READ_HOLDING_REGISTERS, "read of holding registers ", address, words);
}

std::optional<LinkFailure> PlcConnection::write(std::uint16_t address, std::span<const std::uint16_t> words) {
    return ask("write of holding registers " + registers(address, words.size()), write_request(address, words));
}

}  // namespace rig::modbus
