/// Client for the rig's PLC over Modbus TCP or RTU; polls and commands it on its own thread.
///
///     rig::modbus::ModbusClient plc(map, rig::modbus::TcpServer{"192.168.1.10", 502});
///     for (;;) {                                             // the bridge's thread, every 10 ms
///         plc.command(wanted);
///         const auto now = plc.snapshot();
///         if (now.fresh(rig::Measured::vertical_load_N, 0.1)) use(now.values);
///     }
///
/// No call waits for the PLC. Any error on the link (time-out, exception, invalid answer) closes it; it is reopened after a back-off, so that no late
/// answer is taken for that of a later request. Closing does not discard late answers on a serial line: after an error there, the line must first be
/// quiet for the response time-out; then the map version is requested until an answer matches that request.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "rig_bridge/modbus/command_tracker.hpp"
#include "rig_bridge/modbus/plc_address.hpp"
#include "rig_bridge/modbus/plc_line.hpp"
#include "rig_bridge/rig/register_codec.hpp"
#include "rig_bridge/rig/register_map.hpp"

namespace rig::modbus {

enum class LinkState : std::uint8_t {
    connecting,    ///< never been connected
    connected,     ///< the last request was answered
    lost,          ///< waiting for the next attempt
    map_rejected,  ///< the PLC answers with another map version: nothing else is read or written
};
[[nodiscard]] std::string_view name(LinkState state);

struct LinkCounters {
    std::uint64_t requests = 0;
    std::uint64_t timeouts = 0;
    std::uint64_t exceptions = 0;  ///< exception responses
    std::uint64_t errors = 0;      ///< everything else that closed a link
    std::uint64_t connects = 0;    ///< successful ones
    std::uint64_t failed_connects = 0;
    std::uint64_t polls = 0;  ///< complete readings of all measured values
};

struct Snapshot {
    /// The newest readings; NaN before the first reading, or if the PLC sent NaN.
    MeasuredValues values{};
    std::array<ValueQuality, kMeasuredCount> quality{};
    std::array<ClockTime, kMeasuredCount> read_at{};  ///< by the client's clock; 0: never
    std::array<double, kMeasuredCount> age_s{};       ///< infinite: never
    /// Since plc_watchdog was last seen to change; infinite: not since the last connect.
    double plc_watchdog_age_s = 0.0;

    LinkState link = LinkState::connecting;
    std::string error;  ///< why the last link ended or cannot be opened; kept after reconnecting
    LinkCounters counters;

    std::uint16_t commit = 0;  ///< number of the newest command that was sent; 0: none
    CommandState command = CommandState::none;
    /// How long the PLC's confirmation of a command has been pending; 0 if none is.
    double pending_s = 0.0;
    std::string command_error;           ///< of an unsendable command, e.g. "load_base: 90000 N is out of range 0 to 60000"
    std::uint64_t foreign_commands = 0;  ///< commands of other clients that the PLC applied or refused
    std::uint16_t foreign_commit = 0;    ///< number of the newest of them

    [[nodiscard]] double value(Measured q) const { return at(values, q); }
    /// Whether it was read, is at most `limit_s` old, and within its declared range.
    [[nodiscard]] bool fresh(Measured q, double limit_s) const {
        const auto i = static_cast<std::size_t>(q);
        return quality[i] == ValueQuality::good && age_s[i] <= limit_s;
    }
};

/// What triggers polling: the client's own thread, every `poll` of the map; or the caller, in lockstep with a virtual PLC.
enum class Polling : std::uint8_t { own_thread, turns };

class ModbusClient {
  public:
    /// With Polling::own_thread starts the thread, which also connects. `now` is called from both threads and must not decrease. `line`: null means
    /// libmodbus to `address`. Throws std::invalid_argument for an invalid address, or a map that this link cannot carry.
    ModbusClient(
        RegisterMap map, const PlcAddress& address,
        std::function<ClockTime()> now = [] { return std::chrono::steady_clock::now().time_since_epoch(); }, Polling polling = Polling::own_thread,
        std::unique_ptr<PlcLine> line = nullptr);
    /// Waits for the current request, at most a connect or response time-out. Sends no command.
    ~ModbusClient();
    ModbusClient(const ModbusClient&) = delete;
    ModbusClient& operator=(const ModbusClient&) = delete;

    /// Sets the command for the PLC; bridge_watchdog and commit in it are ignored, the client sets them. It is sent if its registers differ from
    /// those last sent, and completely after every reconnection. Includes alive().
    void command(const CommandedValues& wanted);
    /// Keeps the bridge's watchdog counting without a new command. If neither is called for the map's user_timeout, the watchdog register stops and
    /// the PLC trips.
    void alive();

    [[nodiscard]] Snapshot snapshot() const;

    // Polling::turns only, on the caller's thread.
    /// One poll: connects if needed, else reads everything and writes what is due.
    void exchange();
    /// Connects if needed, reads everything.
    void read_all();
    /// Writes what is due, then `number` into the map's bridge_turn. The destructor writes 0 there.
    void write_turn(std::uint16_t number);

  private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace rig::modbus
