/// Transfers frames between client and PLC: by libmodbus over TCP or a serial line; in a simulation, in memory.
#pragma once

#include <cerrno>
#include <cstdint>
#include <memory>
#include <span>

#include "rig_bridge/modbus/plc_address.hpp"
#include "rig_bridge/rig/register_map.hpp"

namespace rig::modbus {

/// Each call returns 0 or an errno; ETIMEDOUT after the map's time-out. Calls of open() and close() alternate.
class PlcLine {
  public:
    static constexpr std::size_t kMaxFrame = 260;  ///< of TCP; those of a serial line are shorter
    /// Result of open(): the serial line never becomes quiet, so that an answer could not be identified.
    static constexpr int kNeverQuiet = EBUSY;

    virtual ~PlcLine() = default;
    /// On a serial line returns after the line has been quiet for the response time-out.
    [[nodiscard]] virtual int open() = 0;
    virtual void close() = 0;
    /// Sends a whole frame, given without checksum on a serial line.
    [[nodiscard]] virtual int send(std::span<const std::uint8_t> frame) = 0;
    /// Receives a whole frame of `size` bytes, including the checksum on a serial line.
    [[nodiscard]] virtual int receive(std::span<std::uint8_t, kMaxFrame> frame, std::size_t& size) = 0;
};

/// Throws std::invalid_argument for an address, or a serial line, that libmodbus cannot use.
[[nodiscard]] std::unique_ptr<PlcLine> libmodbus_line(const RegisterMap& map, const PlcAddress& address);

}  // namespace rig::modbus
