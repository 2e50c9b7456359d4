#include "rig_bridge/modbus/request.hpp"

#include <algorithm>

#include "rig_bridge/modbus/big_endian.hpp"
#include "rig_bridge/rig/register_blocks.hpp"

namespace rig::modbus {
namespace {

constexpr unsigned kSpace = 65536;
constexpr unsigned kMaxReadWritten = 121;  // most registers written by one request of function code 23, section 6.17

Exception judge_read(std::span<const std::uint8_t> pdu, const RegisterSet& registers) {
    if (pdu.size() != 5) return Exception::illegal_data_value;
    const unsigned count = word_at(pdu, 3);
    if (count < 1 || count > kMaxRead) return Exception::illegal_data_value;
    return registers.contains(word_at(pdu, 1), count) ? Exception::none : Exception::illegal_data_address;
}

Exception judge_write_one(std::span<const std::uint8_t> pdu, std::size_t length, const RegisterSet& registers) {
    if (pdu.size() != length) return Exception::illegal_data_value;
    return registers.contains(word_at(pdu, 1), 1) ? Exception::none : Exception::illegal_data_address;
}

/// `at`: offset of address, count, byte count and values.
Exception judge_write(std::span<const std::uint8_t> pdu, std::size_t at, unsigned max, const RegisterSet& registers) {
    if (pdu.size() < at + 5) return Exception::illegal_data_value;
    const unsigned count = word_at(pdu, at + 2);
    const unsigned bytes = pdu[at + 4];
    if (count < 1 || count > max || bytes != 2 * count || pdu.size() != at + 5 + bytes) return Exception::illegal_data_value;
    return registers.contains(word_at(pdu, at), count) ? Exception::none : Exception::illegal_data_address;
}

}  // namespace

RegisterSet::RegisterSet(std::span<const Field> fields) : there_(kSpace, false) {
    for (const Field& field : fields) {
        for (unsigned i = 0; i < width(field.type); ++i) there_[field.address + i] = true;
    }
}

bool RegisterSet::contains(unsigned address, unsigned count) const {
    if (address + count > kSpace) return false;
    for (unsigned i = 0; i < count; ++i) {
        if (!there_[address + i]) return false;
    }
    return true;
}

Exception judge(std::span<const std::uint8_t> pdu, const RegisterSet& inputs, const RegisterSet& holdings) {
    switch (pdu.empty() ? 0 : pdu[0]) {
        case 3:
            return judge_read(pdu, holdings);
        case 4:
            return judge_read(pdu, inputs);
        case 6:
            return judge_write_one(pdu, 5, holdings);
        case 16:
            return judge_write(pdu, 1, kMaxWrite, holdings);
        case 22:
            return judge_write_one(pdu, 7, holdings);
        case 23: {
            const Exception written = judge_write(pdu, 5, kMaxReadWritten, holdings);
            return written == Exception::none || written == Exception::illegal_data_address ? std::max(judge_read(pdu.first(5), holdings), written)
                                                                                            : written;
        }
        default:
            return Exception::illegal_function;
    }
}

TcpFrame tcp_frame(std::span<const std::uint8_t> bytes) {
    if (bytes.size() < kTcpHeader) return {};
    const unsigned protocol = word_at(bytes, 2);
    const unsigned rest = word_at(bytes, 4);  // unit and PDU
    if (protocol != 0 || rest < 2 || rest + 6 > kTcpMax) return {FrameState::broken, 0};
    const std::size_t length = 6 + rest;
    return {bytes.size() < length ? FrameState::incomplete : FrameState::whole, length};
}

}  // namespace rig::modbus
