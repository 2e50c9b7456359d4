/// The bridge without its threads: main loop, client, listener, recorder and ledger, called one after the other, with injected clocks and disk. It
/// runs a campaign as `rig-bridge campaign` does, with the same parts (ManeuverRun, BusListener, Node, summary_of(), enter()). What other threads
/// write there is written here at once, between two steps.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "firmware/can/bus.hpp"
#include "plant_sim/simulation/allocation_gate.hpp"
#include "plant_sim/simulation/campaign_audit.hpp"
#include "rig_bridge/bridge/bus_listener.hpp"
#include "rig_bridge/bridge/maneuver_record.hpp"
#include "rig_bridge/bridge/maneuver_run.hpp"
#include "rig_bridge/bridge/node.hpp"
#include "rig_bridge/record/append_file.hpp"
#include "rig_bridge/record/sample_log.hpp"

namespace plant_sim::simulation {

/// Seeded mistakes of the bridge, for tests of the invariants.
enum class BridgeMistake : std::uint8_t {
    none,
    leaves_plc_tripped,          ///< does not reset a tripped PLC
    watchdog_without_loop,       ///< the client's watchdog counts also without the main loop
    numbers_maneuvers_itself,    ///< computes the next maneuver's number from the number of begun ones, instead of the ledger
    forgets_energy_left,         ///< of an attempt that a dead bridge left
    counts_energy_left_twice,    ///< once for that attempt, once in the next
    enters_before_it_is_synced,  ///< enters a maneuver before its recording is synced
    keeps_wall_clock_stamps,     ///< does not correct the recording's time stamps when the wall clock is set
    waits_by_wall_clock,         ///< for timeouts
    ignores_no_memory,           ///< ignores a failed allocation when entering a maneuver
};

/// The computer on which it runs.
struct BridgeMachine {
    antiskid::can::Bus& send_bus;  ///< two sockets of one computer
    antiskid::can::Bus& receive_bus;
    std::function<antiskid::can::Time()> now;  ///< monotonic
    /// Offset of the wall clock, for a monotonic time.
    std::function<antiskid::can::Time(antiskid::can::Time)> wall_minus_monotonic;
    std::shared_ptr<const SimulatedDisk> disk;
    AllocationGate& gate;
};

/// The campaign, named kSimulatedCampaign.
struct BridgeCampaign {
    std::int64_t planned = 0;
    rig::Plan plan;  ///< the same for every maneuver
};

class BridgeProgram {
  public:
    /// Opens the ledger and settles attempts that a previous bridge left. All references must outlive it. Any exception, here and below, ends the
    /// program.
    BridgeProgram(const rig::bridge::BridgeSetup& setup, BridgeCampaign campaign, BridgeMachine machine, std::unique_ptr<rig::modbus::PlcLine> line,
                  CampaignAudit& audit, BridgeMistake mistake);

    /// One poll of the client's thread.
    void poll();
    /// One pass of the recorder's thread and of the thread that writes its files.
    void receive();
    /// One step of the main loop.
    const rig::bridge::Moment& step();

    /// Null: no maneuver is running.
    [[nodiscard]] const rig::Sequencer* sequencer() const { return run_ ? std::as_const(run_->maneuver).sequencer() : nullptr; }
    /// The newest attempt; attempt 0: none has begun.
    [[nodiscard]] const rig::record::Attempt& attempt() const { return attempt_; }
    [[nodiscard]] bool complete() const { return complete_; }

  private:
    struct Client final : rig::bridge::Plc {
        Client(const rig::RegisterMap& map, std::unique_ptr<rig::modbus::PlcLine> line, std::function<antiskid::can::Time()> now)
            : client(map, rig::modbus::TcpServer{}, std::move(now), rig::modbus::Polling::turns, std::move(line)) {}
        void command(const rig::CommandedValues& wanted) override { client.command(wanted); }
        [[nodiscard]] rig::modbus::Snapshot snapshot() const override { return client.snapshot(); }
        rig::modbus::ModbusClient client;
    };
    struct Feed final : rig::bridge::BusFeed {
        [[nodiscard]] rig::bridge::BusNow now() const override { return state; }
        rig::bridge::BusNow state;
    };
    struct Run {
        rig::bridge::ManeuverRequest request;
        rig::bridge::ManeuverRun maneuver;
        std::string started{};
        std::unique_ptr<rig::bridge::Recording> recording{};
        rig::record::AppendFile* bus_log = nullptr;  // the recording's
        rig::record::AppendFile* modbus_csv = nullptr;
        std::unique_ptr<rig::record::SampleLog> samples{};
    };

    void outside_product(const std::function<void()>& what);
    void open();
    [[nodiscard]] std::optional<rig::record::Summary> meter(const rig::record::Attempt& left);
    [[nodiscard]] std::optional<std::int64_t> next_number() const;
    void begin();
    void begin_record();
    void receive(std::span<rig::record::CapturedFrame> frames, rig::bridge::Recording* recording);
    void write_files();
    void close();
    void enter(const rig::record::Summary& summary);
    /// The monotonic clock as the program reads it, and the wall clock's offset from it.
    [[nodiscard]] antiskid::can::Time time() const;
    [[nodiscard]] antiskid::can::Time offset() const;
    [[nodiscard]] std::string wall_text() const;

    const rig::bridge::BridgeSetup& setup_;
    BridgeCampaign campaign_;
    BridgeMachine machine_;
    CampaignAudit& audit_;
    BridgeMistake mistake_;
    double left_J_ = 0.0;
    std::int64_t next_ = 1;  // numbers_maneuvers_itself

    std::unique_ptr<rig::record::Ledger> ledger_;
    rig::bridge::BusListener listener_;
    Client plc_;
    Feed feed_;
    rig::bridge::Node node_;
    rig::record::Attempt attempt_;
    std::optional<Run> run_;
    antiskid::can::Time next_write_{}, next_sync_{};
    bool complete_ = false;
};

}  // namespace plant_sim::simulation
