/// One link to a PLC. Every call returns within the map's time-outs.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rig_bridge/modbus/plc_address.hpp"
#include "rig_bridge/modbus/plc_line.hpp"
#include "rig_bridge/rig/register_map.hpp"

namespace rig::modbus {

struct LinkFailure {
    enum class Kind : std::uint8_t { timeout, exception, other };
    Kind kind = Kind::other;
    std::string text;  ///< names the link, the request and its registers, and what happened
};

class PlcConnection {
  public:
    PlcConnection(const RegisterMap& map, PlcAddress address, std::unique_ptr<PlcLine> line);

    [[nodiscard]] std::optional<LinkFailure> open();
    void close();
    [[nodiscard]] bool is_open() const { return open_; }

    [[nodiscard]] std::optional<LinkFailure> read_inputs(std::uint16_t address, std::span<std::uint16_t> words);
    [[nodiscard]] std::optional<LinkFailure> read_holdings(std::uint16_t address, std::span<std::uint16_t> words);
    [[nodiscard]] std::optional<LinkFailure> write(std::uint16_t address, std::span<const std::uint16_t> words);

  private:
    /// Sends a PDU and waits for its answer, stored in answer_. Closes the link on failure.
    [[nodiscard]] std::optional<LinkFailure> ask(const std::string& doing, std::span<const std::uint8_t> pdu);
    [[nodiscard]] std::optional<LinkFailure> asked(const std::string& doing, std::span<const std::uint8_t> pdu);
    [[nodiscard]] int send(std::span<const std::uint8_t> pdu);
    [[nodiscard]] std::string frame_fault(std::span<const std::uint8_t> frame) const;
    [[nodiscard]] LinkFailure failure(int number, const std::string& doing, std::chrono::milliseconds timeout) const;
    [[nodiscard]] std::optional<LinkFailure> read(std::uint8_t function, const std::string& doing, std::uint16_t address,
                                                  std::span<std::uint16_t> words);
    [[nodiscard]] bool serial() const { return std::holds_alternative<SerialDevice>(address_); }

    PlcAddress address_;
    LinkTimes times_;
    std::uint8_t unit_;
    std::unique_ptr<PlcLine> line_;
    bool open_ = false;
    std::uint16_t transaction_ = 0;
    std::vector<std::uint8_t> answer_;  // PDU
};

}  // namespace rig::modbus
