/// The bridge without its threads: main loop, client, listener, recorder and ledger, turn by turn on clocks and a disk that are handed in. It runs
/// a campaign as `rig-bridge campaign` does, by the same parts (ManeuverRun, BusListener, Node, summary_of(), enter()); what is written on other
/// threads there is written at once here, between two steps.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "firmware/can/bus.hpp"
#include "plant_sim/simulation/allocation_gate.hpp"
#include "plant_sim/simulation/campaign_books.hpp"
#include "rig_bridge/bridge/bus_listener.hpp"
#include "rig_bridge/bridge/maneuver_record.hpp"
#include "rig_bridge/bridge/maneuver_run.hpp"
#include "rig_bridge/bridge/node.hpp"
#include "rig_bridge/record/append_file.hpp"
#include "rig_bridge/record/sample_log.hpp"

namespace plant_sim::simulation {

/// What a test of the invariants has the bridge do otherwise.
enum class BridgeMistake : std::uint8_t {
    none,
    leads_no_plc_back,           ///< that has tripped
    proves_life_without_loop,    ///< the client's watchdog moves whether or not the main loop does
    counts_by_itself,            ///< which maneuver is next, from how many were begun before it started
    forgets_energy_left,         ///< of an attempt that a dead bridge left
    counts_energy_left_twice,    ///< there, and in the next attempt
    enters_before_it_is_synced,  ///< the recording
    keeps_wall_clock_stamps,     ///< in the recording, when the clock is set
    waits_by_wall_clock,         ///< time-outs
    overlooks_no_memory,         ///< as it enters a maneuver
};

/// The machine that it runs on.
struct BridgeMachine {
    antiskid::can::Bus& sends;  ///< its two sockets
    antiskid::can::Bus& hears;
    std::function<antiskid::can::Time()> now;  ///< monotonic
    /// Of the wall clock, at that time of the other.
    std::function<antiskid::can::Time(antiskid::can::Time)> wall_minus_monotonic;
    std::shared_ptr<const SimulatedDisk> disk;
    AllocationGate& gate;
};

/// What is run, as kSimulatedCampaign.
struct BridgeCampaign {
    std::int64_t planned = 0;
    rig::Plan plan;  ///< of every maneuver
};

class BridgeProgram {
  public:
    /// Opens the ledger and settles what the bridge before it has left. All references must outlive it. Whatever it throws, here and below, ends the
    /// program.
    BridgeProgram(const rig::bridge::BridgeSetup& setup, BridgeCampaign campaign, BridgeMachine machine, std::unique_ptr<rig::modbus::PlcLine> line,
                  CampaignBooks& books, BridgeMistake mistake);

    /// What the client's thread does at each poll.
    void poll();
    /// What the recorder's thread does, and that of its files.
    void receive();
    /// The main loop.
    const rig::bridge::Moment& step();

    /// None: it is between two.
    [[nodiscard]] const rig::Sequencer* sequencer() const { return run_ ? std::as_const(run_->maneuver).sequencer() : nullptr; }
    /// The newest that has begun; attempt 0: none has.
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
        [[nodiscard]] rig::bridge::BusNow now() const override { return heard; }
        rig::bridge::BusNow heard;
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

    void tell_books(const std::function<void()>& what);
    void open();
    [[nodiscard]] std::optional<rig::record::Summary> meter(const rig::record::Attempt& left);
    [[nodiscard]] std::optional<std::int64_t> next_number() const;
    void begin();
    void begin_record();
    void receive(std::span<rig::record::CapturedFrame> frames, rig::bridge::Recording* recording);
    void write_files();
    void close();
    void enter(const rig::record::Summary& summary);
    /// The monotonic clock as the program reads it, and what the wall clock is ahead of that.
    [[nodiscard]] antiskid::can::Time time() const;
    [[nodiscard]] antiskid::can::Time offset() const;
    [[nodiscard]] std::string wall_text() const;

    const rig::bridge::BridgeSetup& setup_;
    BridgeCampaign campaign_;
    BridgeMachine machine_;
    CampaignBooks& books_;
    BridgeMistake mistake_;
    double left_J_ = 0.0;
    std::int64_t next_ = 1;  // counts_by_itself

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
