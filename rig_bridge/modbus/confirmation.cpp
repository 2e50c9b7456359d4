#include "rig_bridge/modbus/confirmation.hpp"

#include <algorithm>
#include <string_view>

#include "rig_bridge/modbus/big_endian.hpp"

namespace rig::modbus {
namespace {

constexpr std::size_t kHeader = 7;
constexpr std::uint8_t kWrite = 16;

void append(std::vector<std::uint8_t>& bytes, unsigned word) {
    bytes.push_back(static_cast<std::uint8_t>(word >> 8U));
    bytes.push_back(static_cast<std::uint8_t>(word & 0xFFU));
}

std::string differs(std::string_view what, unsigned got, unsigned expected) {
    return "answer with " + std::string(what) + " " + std::to_string(got) + ", expected " + std::to_string(expected);
}

}  // namespace

std::vector<std::uint8_t> read_request(std::uint8_t function, std::uint16_t address, std::uint16_t count) {
    std::vector<std::uint8_t> pdu{function};
    append(pdu, address);
    append(pdu, count);
    return pdu;
}

std::vector<std::uint8_t> write_request(std::uint16_t address, std::span<const std::uint16_t> words) {
    std::vector<std::uint8_t> pdu{kWrite};
    append(pdu, address);
    append(pdu, static_cast<unsigned>(words.size()));
    pdu.push_back(static_cast<std::uint8_t>(2 * words.size()));
    for (const std::uint16_t value : words) append(pdu, value);
    return pdu;
}

std::vector<std::uint8_t> tcp_request(std::uint16_t transaction, std::uint8_t unit, std::span<const std::uint8_t> pdu) {
    std::vector<std::uint8_t> frame;
    frame.reserve(kHeader + pdu.size());
    append(frame, transaction);
    append(frame, 0);
    append(frame, static_cast<unsigned>(pdu.size() + 1));
    frame.push_back(unit);
    frame.insert(frame.end(), pdu.begin(), pdu.end());
    return frame;
}

std::string tcp_header_fault(std::uint16_t transaction, std::uint8_t unit, std::span<const std::uint8_t> frame) {
    if (frame.size() <= kHeader) return "answer without a function code";
    if (word_at(frame, 0) != transaction) return differs("transaction", word_at(frame, 0), transaction);
    if (word_at(frame, 2) != 0) return differs("protocol", word_at(frame, 2), 0);
    const auto rest = static_cast<unsigned>(frame.size() - 6);
    if (word_at(frame, 4) != rest) return differs("length", word_at(frame, 4), rest);
    if (frame[6] != unit) return differs("unit", frame[6], unit);
    return {};
}

unsigned exception_of(std::span<const std::uint8_t> request, std::span<const std::uint8_t> answer) {
    return answer.size() == 2 && answer[0] == (request[0] | 0x80U) ? answer[1] : 0;
}

std::string answer_fault(std::span<const std::uint8_t> request, std::span<const std::uint8_t> answer) {
    if (answer.empty()) return "answer without a function code";
    if (answer[0] != request[0]) return differs("function", answer[0], request[0]);
    if (request[0] == kWrite) {
        constexpr std::size_t kEcho = 5;  // function, address, count
        const bool same = answer.size() == kEcho && std::equal(answer.begin(), answer.end(), request.begin());
        return same ? "" : "confirmation of another write";
    }
    const unsigned bytes = 2 * word_at(request, 3);
    if (answer.size() < 2) return "answer without values";
    if (answer[1] != bytes) return differs("byte count", answer[1], bytes);
    const auto values = static_cast<unsigned>(answer.size() - 2);
    return values == bytes ? "" : differs("bytes of values", values, bytes);
}

}  // namespace rig::modbus
