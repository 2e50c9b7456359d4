/// Builds the client's requests and checks the answers. libmodbus transfers the frames but checks neither unit and protocol of a TCP answer nor the
/// confirmation of a write, so all of that is checked here.
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

/// "" if the header of `frame` matches this transaction and the frame's length, else the error.
[[nodiscard]] std::string tcp_header_fault(std::uint16_t transaction, std::uint8_t unit, std::span<const std::uint8_t> frame);

/// Exception code in the answer to `request`; 0: no exception.
[[nodiscard]] unsigned exception_of(std::span<const std::uint8_t> request, std::span<const std::uint8_t> answer);
/// "" if PDU `answer` matches PDU `request` in function, length, byte count, and the confirmed addresses and values; else the error.
[[nodiscard]] std::string answer_fault(std::span<const std::uint8_t> request, std::span<const std::uint8_t> answer);

}  // namespace rig::modbus
