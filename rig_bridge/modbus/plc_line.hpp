/// The frames between a client and a PLC, whatever they mean: by libmodbus over TCP or a serial line; in a simulation, in memory.
#pragma once

#include <cerrno>
#include <cstdint>
#include <memory>
#include <span>

#include "rig_bridge/modbus/plc_address.hpp"
#include "rig_bridge/rig/register_map.hpp"

namespace rig::modbus {

/// Each call returns 0, or the errno of what failed: ETIMEDOUT where it took longer than the map's time-out. A line is opened after it was
/// closed, and the other way round.
class PlcLine {
  public:
    static constexpr std::size_t kMaxFrame = 260;  ///< of TCP; those of a serial line are shorter
    /// open(): bytes keep coming on a serial line, so that none could be told to be an answer.
    static constexpr int kNeverQuiet = EBUSY;

    virtual ~PlcLine() = default;
    /// A serial line is open when it has been quiet for the response time-out.
    [[nodiscard]] virtual int open() = 0;
    virtual void close() = 0;
    /// A whole frame, on a serial line without its checksum.
    [[nodiscard]] virtual int send(std::span<const std::uint8_t> frame) = 0;
    /// A whole frame, on a serial line with its checksum, of `size` bytes.
    [[nodiscard]] virtual int receive(std::span<std::uint8_t, kMaxFrame> frame, std::size_t& size) = 0;
};

/// Throws std::invalid_argument for an address, or a serial line, that libmodbus cannot use.
[[nodiscard]] std::unique_ptr<PlcLine> libmodbus_line(const RegisterMap& map, const PlcAddress& address);

}  // namespace rig::modbus
