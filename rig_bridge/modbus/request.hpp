/// Validates requests to a server before libmodbus answers them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rig_bridge/rig/register_map.hpp"

namespace rig::modbus {

/// The addresses that exist in one register space.
class RegisterSet {
  public:
    explicit RegisterSet(std::span<const Field> fields);
    [[nodiscard]] bool contains(unsigned address, unsigned count) const;

  private:
    std::vector<bool> there_;
};

/// Modbus V1.1b3, 6 and 7.
enum class Exception : std::uint8_t {
    none = 0,
    illegal_function = 1,
    illegal_data_address = 2,
    illegal_data_value = 3,
};

/// The exception with which to answer a request. Accepts function codes 3, 4, 6, 16, 22, 23; the length, and counts and byte counts against each
/// other, are checked before the addresses. `pdu`: from the function code on, without checksum.
[[nodiscard]] Exception judge(std::span<const std::uint8_t> pdu, const RegisterSet& inputs, const RegisterSet& holdings);

enum class FrameState : std::uint8_t { incomplete, whole, broken };
struct TcpFrame {
    FrameState state = FrameState::incomplete;
    std::size_t length = 0;  ///< of a whole frame, header included
};
inline constexpr std::size_t kTcpHeader = 7;
inline constexpr std::size_t kTcpMax = 260;
/// The frame at the beginning of `bytes`, by its header: protocol 0, a unit and 1 to 253 bytes follow.
[[nodiscard]] TcpFrame tcp_frame(std::span<const std::uint8_t> bytes);

}  // namespace rig::modbus
