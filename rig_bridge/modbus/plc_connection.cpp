#include "rig_bridge/modbus/plc_connection.hpp"

#include <array>
#include <utility>

#include "rig_bridge/modbus/confirmation.hpp"
#include "rig_bridge/modbus/modbus_context.hpp"

namespace rig::modbus {
namespace {

std::string registers(std::uint16_t address, std::size_t count) {
    return std::to_string(address) + (count > 1 ? " to " + std::to_string(address + count - 1) : "");
}

std::string exception_text(unsigned code) {
    constexpr unsigned kLast = 11;
    return code <= kLast ? modbus_error(MODBUS_ENOBASE + static_cast<int>(code))
                         : "exception " + std::to_string(code) + ", which no specification has";
}

}  // namespace

PlcConnection::PlcConnection(const RegisterMap& map, PlcAddress address, std::unique_ptr<PlcLine> line)
    : address_(std::move(address)), times_(map.link), unit_(map.unit_id), line_(std::move(line)) {}

LinkFailure PlcConnection::failure(int number, const std::string& doing, std::chrono::milliseconds timeout) const {
    const std::string what = to_string(address_) + ": " + doing + ": ";
    if (number == ETIMEDOUT) return {LinkFailure::Kind::timeout, what + "no answer within " + std::to_string(timeout.count()) + " ms"};
    return {LinkFailure::Kind::other, what + modbus_error(number)};
}

std::optional<LinkFailure> PlcConnection::open() {
    const int number = line_->open();
    if (number == 0) {
        open_ = true;
        return std::nullopt;
    }
    close();
    if (number == PlcLine::kNeverQuiet) return LinkFailure{LinkFailure::Kind::other, to_string(address_) + ": the line is never quiet"};
    return failure(number, "connect", times_.connect_timeout);
}

void PlcConnection::close() {
    line_->close();
    open_ = false;
}

int PlcConnection::send(std::span<const std::uint8_t> pdu) {
    if (!serial()) return line_->send(tcp_request(++transaction_, unit_, pdu));
    std::vector<std::uint8_t> request{unit_};
    request.insert(request.end(), pdu.begin(), pdu.end());
    return line_->send(request);
}

std::string PlcConnection::frame_fault(std::span<const std::uint8_t> frame) const {
    if (!serial()) return tcp_header_fault(transaction_, unit_, frame);
    return frame[0] == unit_ ? "" : "answer of another unit: " + std::to_string(frame[0]);
}

std::optional<LinkFailure> PlcConnection::asked(const std::string& doing, std::span<const std::uint8_t> pdu) {
    if (const int number = send(pdu); number != 0) return failure(number, doing, times_.response_timeout);
    std::array<std::uint8_t, PlcLine::kMaxFrame> bytes{};
    std::size_t size = 0;
    if (const int number = line_->receive(bytes, size); number != 0) return failure(number, doing, times_.response_timeout);
    const auto frame = std::span(bytes).first(size);
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
