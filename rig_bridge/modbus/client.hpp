/// The rig's PLC as the bridge sees it: polled and commanded by a thread of its own, over TCP or RTU.
///
///     rig::modbus::ModbusClient plc(map, rig::modbus::TcpServer{"192.168.1.10", 502});
///     for (;;) {                                             // the bridge's thread, every 10 ms
///         plc.command(wanted);
///         const auto now = plc.snapshot();
///         if (now.fresh(rig::Measured::vertical_load_N, 0.1)) use(now.values);
///     }
///
/// No call waits for the PLC. Whatever goes wrong on the link (time-out, exception, an answer that is none) closes it;
/// it is opened anew after a back-off, so that no late answer can be taken for that of a later request. A serial line
/// cannot forget its late answers by closing: there, after an error, the line must first be quiet for the response
/// time-out, then the map version is asked for until the answer has that request's shape.
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
    map_rejected,  ///< the PLC answers, but its map version is another one: nothing is read or written
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
    /// The newest reading; NaN before the first and where the PLC sent NaN.
    MeasuredValues values{};
    std::array<ValueQuality, kMeasuredCount> quality{};
    std::array<ClockTime, kMeasuredCount> read_at{};  ///< by the client's clock; 0: never
    std::array<double, kMeasuredCount> age_s{};       ///< infinite: never
    /// Since plc_watchdog was last seen to change; infinite: not since the last connect.
    double plc_watchdog_age_s = 0.0;

    LinkState link = LinkState::connecting;
    std::string error;  ///< what ended the last link, or keeps it from opening; stays for the record
    LinkCounters counters;

    std::uint16_t commit = 0;  ///< of the newest command that was sent; 0: none
    CommandState command = CommandState::none;
    /// How long the PLC has owed its confirmation of something commanded; 0 unless pending.
    double pending_s = 0.0;
    std::string command_error;           ///< of an unsendable command, e.g. "load_base: 90000 N is out of range 0 to 60000"
    std::uint64_t foreign_commands = 0;  ///< that the PLC took over or refused, and that were not this client's
    std::uint16_t foreign_commit = 0;    ///< number of the newest of them

    [[nodiscard]] double value(Measured q) const { return at(values, q); }
    /// Read, at most `limit_s` old, and within its declared range.
    [[nodiscard]] bool fresh(Measured q, double limit_s) const {
        const auto i = static_cast<std::size_t>(q);
        return quality[i] == ValueQuality::good && age_s[i] <= limit_s;
    }
};

/// Who says when the PLC is polled: the client's own thread, every `poll` of the map; or the caller, in lockstep with a virtual PLC.
enum class Polling : std::uint8_t { own_thread, turns };

class ModbusClient {
  public:
    /// Starts the thread where polling is its own; connecting is its business. `now` is asked from both threads and does not fall. `line`:
    /// none is libmodbus's to `address`. Throws std::invalid_argument for an address that is none, or a map that this link cannot carry.
    ModbusClient(
        RegisterMap map, const PlcAddress& address,
        std::function<ClockTime()> now = [] { return std::chrono::steady_clock::now().time_since_epoch(); }, Polling polling = Polling::own_thread,
        std::unique_ptr<PlcLine> line = nullptr);
    /// Ends after the request that is on its way, at most a connect or response time-out. Commands nothing.
    ~ModbusClient();
    ModbusClient(const ModbusClient&) = delete;
    ModbusClient& operator=(const ModbusClient&) = delete;

    /// What the PLC shall do from now on; bridge_watchdog and commit are the client's own and ignored here. Sent when it
    /// differs, as the registers show it, from what was last sent, and whole after every reconnection. Proves that the
    /// caller is alive, as alive() does.
    void command(const CommandedValues& wanted);
    /// The caller is alive but has nothing new to say. When neither is called for the map's user_timeout, the
    /// watchdog register stands still and the PLC trips.
    void alive();

    [[nodiscard]] Snapshot snapshot() const;

    // Polling::turns only, on the caller's thread.
    /// What the thread does at each poll: connects; or, where it is connected, reads everything and writes what is due.
    void round();
    /// Connects where it must, reads everything.
    void look();
    /// Writes what is due, and last `number` into the map's bridge_turn. The destructor writes 0 there.
    void turn(std::uint16_t number);

  private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace rig::modbus
