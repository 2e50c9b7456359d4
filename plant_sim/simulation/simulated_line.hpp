/// The connection from the bridge's Modbus client to the PLC's registers, in memory, on a simulated clock, with the frames of Modbus TCP.
///
/// A missing answer takes no time here. The real client would wait for it: it must not be called again before `busy_until`.
#pragma once

#include <array>
#include <deque>
#include <vector>

#include "firmware/host/settings/file_descriptor.hpp"
#include "rig_bridge/modbus/command_tracker.hpp"
#include "rig_bridge/modbus/modbus_context.hpp"
#include "rig_bridge/modbus/plc_line.hpp"
#include "rig_bridge/modbus/register_bank.hpp"
#include "rig_bridge/wear/draw.hpp"

namespace plant_sim::simulation {

/// `request_lost`: the PLC does not act on it; `answer_lost`: it does. `answer_damaged`: a bit of the header or function code.
enum class RequestFault : std::uint8_t { request_lost, answer_lost, answer_damaged, request_doubled };
inline constexpr std::size_t kRequestFaults = 4;

/// State shared by the cell and the connections of successive clients.
struct LineState {
    std::array<double, kRequestFaults> shares{};  ///< of the requests that get each fault
    bool reachable = true;
    rig::modbus::ClockTime now{};
    rig::modbus::ClockTime busy_until{};
    std::array<std::uint64_t, kRequestFaults> fault_counts{};
};

class SimulatedLine final : public rig::modbus::PlcLine {
  public:
    /// All arguments but `times` must outlive it. Throws std::system_error if the process has no descriptor left.
    SimulatedLine(rig::modbus::RegisterBank& bank, const rig::LinkTimes& times, LineState& state, wear::Generator& draw);

    [[nodiscard]] int open() override;
    void close() override { arrived_.clear(); }
    [[nodiscard]] int send(std::span<const std::uint8_t> frame) override;
    [[nodiscard]] int receive(std::span<std::uint8_t, kMaxFrame> frame, std::size_t& size) override;

  private:
    [[nodiscard]] bool occurs(RequestFault fault);
    void answer(std::span<const std::uint8_t> request);

    rig::modbus::RegisterBank& bank_;
    rig::LinkTimes times_;
    LineState& state_;
    wear::Generator& draw_;
    rig::modbus::ModbusContext context_;
    std::array<settings::FileDescriptor, 2> pair_;  // libmodbus writes its answers into the first
    std::deque<std::vector<std::uint8_t>> arrived_;
};

}  // namespace plant_sim::simulation
