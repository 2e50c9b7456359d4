/// One link to a PLC, opened and closed. Every call ends within the map's time-outs.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "rig_bridge/modbus/modbus_context.hpp"
#include "rig_bridge/modbus/plc_address.hpp"
#include "rig_bridge/registers/register_map.hpp"

namespace rig {

struct LinkFailure {
    enum class Kind : std::uint8_t { timeout, exception, other };
    Kind kind = Kind::other;
    std::string text;  ///< names the link, the request and its registers, and what happened
};

class PlcConnection {
  public:
    /// Throws std::invalid_argument for an address, or a serial line, that libmodbus cannot use.
    PlcConnection(const RegisterMap& map, PlcAddress address);

    /// On a serial line also waits until it has been quiet for the response time-out.
    [[nodiscard]] std::optional<LinkFailure> open();
    void close();
    [[nodiscard]] bool is_open() const { return open_; }

    [[nodiscard]] std::optional<LinkFailure> read_inputs(std::uint16_t address,
                                                         std::span<std::uint16_t> words);
    [[nodiscard]] std::optional<LinkFailure> read_holdings(std::uint16_t address,
                                                           std::span<std::uint16_t> words);
    [[nodiscard]] std::optional<LinkFailure> write(std::uint16_t address,
                                                   std::span<const std::uint16_t> words);

  private:
    void limit(std::chrono::milliseconds timeout);
    /// False when bytes keep coming.
    [[nodiscard]] bool wait_until_quiet() const;
    [[nodiscard]] LinkFailure failure(const std::string& doing, std::chrono::milliseconds timeout) const;
    [[nodiscard]] std::optional<LinkFailure> judged(int done, const char* doing, std::uint16_t address,
                                                    std::size_t count);

    PlcAddress address_;
    LinkTimes times_;
    ModbusContext context_;
    bool open_ = false;
};

}  // namespace rig
