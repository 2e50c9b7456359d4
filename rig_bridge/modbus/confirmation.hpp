/// Requests of a client and whether what came back answers them. libmodbus moves the frames; it looks at neither unit nor
/// protocol of a TCP answer, nor at what a write confirms, so all of that is checked here.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace rig::modbus {

/// Function code 3 or 4.
[[nodiscard]] std::vector<std::uint8_t> read_request(std::uint8_t function, std::uint16_t address, std::uint16_t count);
/// Function code 16.
[[nodiscard]] std::vector<std::uint8_t> write_request(std::uint16_t address, std::span<const std::uint16_t> words);
/// A TCP frame around a PDU.
[[nodiscard]] std::vector<std::uint8_t> tcp_request(std::uint16_t transaction, std::uint8_t unit, std::span<const std::uint8_t> pdu);

/// "" when the header of `frame` is that of the answer to this transaction and fits its length.
[[nodiscard]] std::string tcp_header_fault(std::uint16_t transaction, std::uint8_t unit, std::span<const std::uint8_t> frame);

/// Code of an exception in answer to `request`; 0: it is none.
[[nodiscard]] unsigned exception_of(std::span<const std::uint8_t> request, std::span<const std::uint8_t> answer);
/// "" when PDU `answer` answers PDU `request`: function, length, byte count, and what was written where.
[[nodiscard]] std::string answer_fault(std::span<const std::uint8_t> request, std::span<const std::uint8_t> answer);

}  // namespace rig::modbus
