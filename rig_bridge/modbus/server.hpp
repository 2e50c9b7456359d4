/// Modbus server of a virtual PLC: serves a register map over TCP and RTU, on its own thread.
///
///     rig::modbus::ModbusServer server(map, {.port = 1502});
///     for (;;) {                                         // the plant's thread, every scan
///         const auto orders = server.exchange(measured);
///         plc.scan(orders.commanded, ...);
///     }
///
/// Function codes 3 and 6, 16, 22, 23 on holding registers, 4 on input registers; illegal function, address and value
/// are answered by their exceptions. A register that is not in the map does not exist. Each request is answered from a single exchange(), so that
/// values are consistent.
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
    /// Largest number of TCP connections. A further one replaces the one with the longest time since its last request, if that is at least `idle`, so
    /// that idle clients do not block others; otherwise it is closed at once.
    std::size_t clients = 8;
    std::chrono::milliseconds idle{1000};
    /// Numeric IPv4 of the peers that may connect; others are closed before a byte of theirs is read.
    std::vector<std::string> allow{"127.0.0.1"};
    /// Called once for each other address (for the first kMaxNamed), on the server's thread.
    std::function<void(const std::string& peer)> on_rejected = nullptr;
    static constexpr std::size_t kMaxNamed = 64;
};

/// Commands received by the PLC.
struct PlcCommands {
    /// Values at the last change of `commit` to a number other than 0; all 0 before that. Only bridge_watchdog is always current. Values out of range
    /// and NaN are passed on: the PLC must refuse them.
    CommandedValues commanded{};
    unsigned open_interlocks = 0;  ///< bit i: Interlock i is forced open
};

struct ServerCounters {
    std::uint64_t requests = 0;
    std::uint64_t exceptions = 0;  ///< requests answered by one
    std::uint64_t broken = 0;      ///< invalid frames: TCP connection closed, RTU line flushed
    std::uint64_t hangs = 0;
    std::uint64_t rejected = 0;  ///< TCP connections of peers that are not allowed
    std::uint64_t idle = 0;      ///< idle TCP connections closed in favour of new ones
    std::size_t clients = 0;     ///< TCP connections now
};

class ModbusServer {
  public:
    /// The server is running when it returns. Throws std::runtime_error that names address and port, or the pseudo-terminal, and the reason;
    /// std::invalid_argument for an allowed peer that is not an address.
    ModbusServer(const RegisterMap& map, const ServerOptions& options);
    /// Stops the thread, even during a commanded hang, and closes every connection.
    ~ModbusServer();
    ModbusServer(const ModbusServer&) = delete;
    ModbusServer& operator=(const ModbusServer&) = delete;

    [[nodiscard]] std::uint16_t port() const;    ///< 0 without TCP
    [[nodiscard]] std::string rtu_path() const;  ///< where RTU clients connect; "" without RTU

    /// Sets the input registers to `measured` and returns the newest commands. Waits at most for a copy of the registers, never for a client. Values
    /// are limited to their declared range; NaN leaves a register unchanged. map_version is always the map's own.
    PlcCommands exchange(const MeasuredValues& measured);

    /// The map's bridge_turn; commands written before it are visible in exchange(). 0 if the map has none.
    [[nodiscard]] std::uint16_t bridge_turn() const;

    [[nodiscard]] ServerCounters counters() const;

  private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace rig::modbus
