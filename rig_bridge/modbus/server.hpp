/// The Modbus side of a PLC that exists in software only: serves a register map, TCP and RTU, on a thread of its own.
///
///     rig::modbus::ModbusServer server(map, {.port = 1502});
///     for (;;) {                                         // the plant's thread, every scan
///         const auto orders = server.exchange(measured);
///         plc.scan(orders.commanded, ...);
///     }
///
/// Function codes 3 and 6, 16, 22, 23 on holding registers, 4 on input registers; illegal function, address and value
/// are answered by their exceptions. A register that is not in the map does not exist. One request is answered from
/// one exchange(): never half old, half new.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rig_bridge/rig/register_map.hpp"

namespace rig::modbus {

struct ServerOptions {
    std::string address = "127.0.0.1";      ///< numeric IPv4; 0.0.0.0: every interface
    std::optional<std::uint16_t> port = 0;  ///< 0: any free one; none: no TCP
    bool rtu = false;                       ///< a pseudo-terminal, see rtu_path()
    /// TCP connections at once. One more takes the place of the one that has asked nothing for longest, if that is `idle` or longer: a
    /// client that only connects, or sends half a request, keeps nobody out. Else it is closed as it comes.
    std::size_t clients = 8;
    std::chrono::milliseconds idle{1000};
    /// Numeric IPv4 of the peers that may connect; others are closed before a byte of theirs is read.
    std::vector<std::string> allow{"127.0.0.1"};
    /// Told of each other address the first time that it comes (of the first kMaxNamed), on the server's thread.
    std::function<void(const std::string& peer)> on_rejected = nullptr;
    static constexpr std::size_t kMaxNamed = 64;
};

/// What the PLC has been told.
struct PlcCommands {
    /// As they all stood when `commit` last changed to another number than 0; before that all 0. Only bridge_watchdog
    /// is of now. What no range holds, NaN included, is handed on as it is: refusing it is the PLC's business.
    CommandedValues commanded{};
    unsigned open_interlocks = 0;  ///< bit i: Interlock i is forced open
};

struct ServerCounters {
    std::uint64_t requests = 0;
    std::uint64_t exceptions = 0;  ///< requests answered by one
    std::uint64_t broken = 0;      ///< frames that were none: TCP connection closed, RTU line flushed
    std::uint64_t hangs = 0;
    std::uint64_t rejected = 0;  ///< TCP connections of peers that are not allowed
    std::uint64_t idle = 0;      ///< TCP connections that were closed for another's sake
    std::size_t clients = 0;     ///< TCP connections now
};

class ModbusServer {
  public:
    /// Serves when it returns. Throws std::runtime_error that names address and port, or the pseudo-terminal, and the
    /// reason; std::invalid_argument for an allowed peer that is no address.
    ModbusServer(const RegisterMap& map, const ServerOptions& options);
    /// Stops the thread, also out of a hang, and closes every connection.
    ~ModbusServer();
    ModbusServer(const ModbusServer&) = delete;
    ModbusServer& operator=(const ModbusServer&) = delete;

    [[nodiscard]] std::uint16_t port() const;    ///< 0 without TCP
    [[nodiscard]] std::string rtu_path() const;  ///< where RTU clients connect; "" without RTU

    /// New measured values for the input registers, newest orders back. Waits for no client, at most for a copy of the
    /// registers. A value outside its declared range is saturated; NaN leaves its register as it was. map_version is the
    /// map's own, whatever `measured` says.
    PlcCommands exchange(const MeasuredValues& measured);

    /// What stands in the map's bridge_turn, after all orders that were written before it; 0 where the map has none.
    [[nodiscard]] std::uint16_t bridge_turn() const;

    [[nodiscard]] ServerCounters counters() const;

  private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace rig::modbus
