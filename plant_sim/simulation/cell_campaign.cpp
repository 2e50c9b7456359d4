#include "plant_sim/simulation/cell_campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "firmware/host/seconds.hpp"
#include "plant_sim/simulation/cell_judge.hpp"
#include "plant_sim/simulation/controller_program.hpp"
#include "plant_sim/simulation/fault_timeline.hpp"
#include "plant_sim/simulation/faulty_bus.hpp"
#include "plant_sim/simulation/ledger_judge.hpp"
#include "plant_sim/simulation/simulated_clock.hpp"
#include "plant_sim/simulation/simulated_line.hpp"
#include "plant_sim/virtual_rig/serve_node.hpp"

namespace plant_sim::simulation {

using antiskid::can::Frame;
using antiskid::control::Time;
using antiskid::host::seconds;
using rig::Phase;

namespace {

rig::Plan plan_of(const CellSetup& setup) {
    constexpr double kSpeed_mps = 10.0;
    rig::Plan plan = setup.bridge.scenario.mean;
    plan.speed_mps = kSpeed_mps;
    return plan;
}

class CellCampaign {
  public:
    CellCampaign(const CellSetup& setup, std::uint64_t seed, std::span<const PlannedFault> faults, const CellTrace& trace)
        : setup_(setup),
          trace_(trace),
          draw_(wear::generator_of(seed, 2)),  // the other streams are for faults and disk
          period_(duration(static_cast<double>(setup.controller.period_s))),
          layout_(setup.bridge.layout),
          planned_(static_cast<std::int64_t>(1 + draw_() % 2)),
          plan_(plan_of(setup)),
          max_sound_attempts_(planned_ + 3 * static_cast<std::int64_t>(faults.size()) + 3),
          disk_(std::make_shared<SimulatedDisk>(seed)),
          gate_(std::make_shared<AllocationGate>(setup.allocations)),
          audit_(disk_),
          account_(0.5 * setup.bridge.meter.flywheel_mass_kg * plan_.speed_mps * plan_.speed_mps),
          recomputed_(setup.bridge, disk_),
          bus_(draw_),
          at_rig_(bus_.connect()),
          at_controller_(bus_.connect()),
          bridge_send_bus_(bus_.connect(true)),
          bridge_receive_bus_(bus_.connect()),
          bank_(setup.bridge.map),
          rig_(setup.bridge.scenario.rig, setup.machinery, seed),
          serving_(rig_, layout_, at_rig_, clock_, period_, [this](plc::ServedRig& rig) { exchange(rig); }),
          judge_(setup, plan_, rig_, [this](const std::string& what) { violated(what); }),
          faults_(faults),
          controller_(setup.controller, layout_, period_, at_controller_) {
        disk_->use(gate_);
        bridge_receive_bus_.on_computer_of(bridge_send_bus_);
        at_controller_.observe([this](const Frame& frame, bool damaged) {
            if (!damaged) judge_.controller_received(frame);
        });
        at_rig_.observe([this](const Frame& frame, bool damaged) {
            if (!damaged) judge_.rig_received(frame);
        });
    }

    CellOutcome run() {
        constexpr double kLongest_s = 3000.0;
        while (!complete_ && out_.violations.empty()) {
            period();
            if (sound_attempts_ > max_sound_attempts_ || seconds(clock_.now()) > kLongest_s)
                violated(fmt::format("the campaign does not come to its end: {} maneuvers in {} attempts", planned_, out_.attempts));
        }
        if (out_.violations.empty()) {
            end_bridge(clock_.now());
            disk_->restart();  // the power is cut at the end
            check_disk();
            check_numbers();
        }
        out_.simulated_s = seconds(clock_.now());
        for (const std::uint64_t frames : bus_.fault_counts()) out_.faulted_frames += frames;
        for (const std::uint64_t requests : line_.fault_counts) out_.faulted_requests += requests;
        out_.disk_fault_counts = disk_->fault_counts();
        out_.damaged = audit_.damaged();
        out_.operations = disk_->operations();
        return std::move(out_);
    }

  private:
    void trace_line(const std::string& line) const {
        if (trace_) trace_(fmt::format("{:9.3f} s  {}", seconds(clock_.time()), line));
    }
    void violated(const std::string& what) {
        trace_line("VIOLATION: " + what);
        out_.violations.push_back(what);
    }

    void period() {
        clock_.advance(period_);
        bus_.set_time(clock_.now());
        line_.now = clock_.now();
        if (faults_.advance(clock_.now(), [this](const PlannedFault& fault, bool begins) { change(fault, begins); })) apply();
        serving_.period();
        account_.advance(clock_.now(), rig_.cumulative_energy_J());
        controller_turn();
        bridge_turn();
        const Time now = clock_.now();
        judge_.check({.now = now,
                      .loop_lives = bridge_ && now >= bridge_away_ && now >= loop_away_,
                      .plc_reachable = line_.reachable,
                      .plc_frozen = frozen_,
                      .controller_lives = controller_.runs() && now >= controller_away_,
                      .open = open_,
                      .sequencer = bridge_ ? bridge_->sequencer() : nullptr});
    }

    void exchange(plc::ServedRig& rig) {
        if (!frozen_) rig.command(bank_.exchange(rig.measured()).commanded);
        rig.open_interlocks(setup_.interlocks_trip ? open_ : 0U);
    }

    // --- faults ---

    /// Events at the beginning or end of a fault.
    void change(const PlannedFault& fault, bool begins) {
        trace_line(begins ? "begins: " + text(fault) : "is over: " + std::string(kCellFaultNames.at(static_cast<std::size_t>(fault.fault))));
        if (fault.fault == CellFault::clock_set) clock_.set_wall(duration(begins ? fault.set_s : -fault.set_s));
        if (!begins) {
            const std::vector<PlannedFault> left = faults_.active();
            const auto is_of_disk = [](const PlannedFault& other) { return of_disk(other.fault); };
            if (of_disk(fault.fault) && std::none_of(left.begin(), left.end(), is_of_disk)) disk_->clear_faults();
            return;
        }
        ++out_.begun.at(static_cast<std::size_t>(fault.fault));
        const Time until = clock_.now() + duration(fault.lasts_s);
        switch (fault.fault) {
            case CellFault::controller_killed:
                controller_.kill();
                controller_away_ = until;
                break;
            case CellFault::controller_stopped:
                controller_away_ = until;
                break;
            case CellFault::bridge_killed:
                disk_->kill();
                end_bridge(until);
                break;
            case CellFault::bridge_stopped:
                bridge_away_ = until;
                break;
            case CellFault::bridge_hangs:
                loop_away_ = until;
                break;
            default:
                if (of_disk(fault.fault)) inject(fault);
                break;
        }
    }

    void inject(const PlannedFault& fault) {
        constexpr std::array kKinds{DiskFault::power_cut, DiskFault::kill, DiskFault::no_space, DiskFault::refused, DiskFault::short_write};
        const DiskFault kind = kKinds.at(static_cast<std::size_t>(fault.fault) - static_cast<std::size_t>(CellFault::power_cut));
        disk_->inject_soon(fault.operation, kind, kind == DiskFault::no_space ? fault.operations : 1);
        if (kind == DiskFault::power_cut || kind == DiskFault::kill) down_ = duration(fault.lasts_s);
    }

    /// Effects that last as long as a fault.
    void apply() {
        for (FaultyBus::End* const end : {&at_rig_, &at_controller_, &bridge_send_bus_, &bridge_receive_bus_}) end->clear_faults();
        line_.shares.fill(0.0);
        line_.reachable = true;
        frozen_ = false;
        open_ = 0;
        std::array<bool, kBusNodeNames.size()> up{true, true, true};
        for (const PlannedFault& p : faults_.active()) {
            if (p.fault < CellFault::off_bus) end_of(p.node).set_share(static_cast<FrameFault>(p.fault), p.share);
            if (p.fault == CellFault::off_bus) up.at(static_cast<std::size_t>(p.node)) = false;
            if (p.fault >= CellFault::requests_lost && p.fault <= CellFault::requests_doubled)
                line_.shares.at(static_cast<std::size_t>(p.fault) - static_cast<std::size_t>(CellFault::requests_lost)) = p.share;
            if (p.fault == CellFault::plc_unreachable) line_.reachable = false;
            if (p.fault == CellFault::plc_frozen) frozen_ = true;
            if (p.fault == CellFault::interlock_open) open_ |= 1U << static_cast<unsigned>(p.interlock);
        }
        at_rig_.set_up(up[0]);
        at_controller_.set_up(up[1]);
        bridge_send_bus_.set_up(up[2]);
        bridge_receive_bus_.set_up(up[2] && bridge_);
    }

    FaultyBus::End& end_of(BusNode node) {
        return node == BusNode::rig ? at_rig_ : node == BusNode::controller ? at_controller_ : bridge_receive_bus_;
    }

    // --- the programs ---

    void controller_turn() {
        if (clock_.now() < controller_away_) return controller_.miss();
        if (!controller_.runs()) judge_.restarted();
        controller_.period(clock_.now());
    }

    /// For any kind of end. The disk is checked before the next bridge starts.
    void end_bridge(Time until) {
        line_.reachable = disk_->runs();  // a bridge without power sends nothing more
        bridge_.reset();
        account_.bridge_ended();
        apply();
        bridge_away_ = until;
        if (disk_->power_cut()) {
            controller_.kill();
            controller_away_ = until;
        }
        if (!disk_->runs()) disk_->restart();
        check_disk();
    }

    void start_bridge() {
        ++out_.starts;
        trace_line("the bridge starts");
        bridge_receive_bus_.set_up(bridge_send_bus_.status().up);
        judge_.restarted();
        next_step_ = clock_.now();
        next_poll_ = line_.busy_until = Time{};
        bridge_ =
            std::make_unique<BridgeProgram>(setup_.bridge, BridgeCampaign{.planned = planned_, .plan = plan_},
                                            BridgeMachine{.send_bus = bridge_send_bus_,
                                                          .receive_bus = bridge_receive_bus_,
                                                          .now = [this] { return clock_.now(); },
                                                          .wall_minus_monotonic = [this](Time at) { return clock_.wall_minus_monotonic(at); },
                                                          .disk = disk_,
                                                          .gate = *gate_},
                                            std::make_unique<SimulatedLine>(bank_, setup_.bridge.map.link, line_, draw_), audit_, setup_.mistake);
    }

    void bridge_turn() {
        if (clock_.now() < bridge_away_) return;
        try {
            if (!bridge_) start_bridge();
            run_bridge();
        } catch (const std::exception& error) {  // LedgerError, settings::Error, a recording that cannot be made, no memory
            if (disk_->runs()) {
                constexpr Time kService{1'000'000'000};
                trace_line(fmt::format("the bridge ends: {}", error.what()));
                ++out_.refusals;
                end_bridge(clock_.now() + kService);
            }
        }
        if (!disk_->runs()) {
            trace_line(disk_->power_cut() ? "the power is cut" : "the bridge is killed");
            end_bridge(clock_.now() + down_);
        }
    }

    void run_bridge() {
        const Time now = clock_.now();
        if (now >= std::max(next_poll_, line_.busy_until)) {
            next_poll_ = now + setup_.bridge.map.link.poll;
            bridge_->poll();
        }
        if (now < next_step_) return;
        next_step_ = now + rig::bridge::Node::kStep;
        bridge_->receive();
        if (now < loop_away_) return;
        (void)bridge_->step();
        if (disk_->runs()) follow();
        complete_ = disk_->runs() && bridge_->complete();
    }

    void follow() {
        if (bridge_->attempt().folder != attempt_folder_ && bridge_->attempt().attempt != 0) {
            attempt_folder_ = bridge_->attempt().folder;
            ++out_.attempts;
            if (!faults_.any()) ++sound_attempts_;
            trace_line(fmt::format("maneuver {}, attempt {}", bridge_->attempt().number, bridge_->attempt().attempt));
            phase_ = Phase::finished;
        }
        const rig::Sequencer* const sequencer = bridge_->sequencer();
        if (sequencer == nullptr || sequencer->phase() == phase_) return;
        if (phase_ == Phase::finished) {
            judge_.begun();
            account_.begun(attempt_folder_);
        }
        phase_ = sequencer->phase();
        trace_line(fmt::format("{}{}", rig::name(phase_), phase_ == Phase::aborting ? fmt::format(": {}", rig::name(sequencer->abort())) : ""));
        faults_.reached(phase_, out_.attempts, clock_.now());
        if (!sequencer->over()) return;
        judge_.over(*sequencer);
        if (phase_ == Phase::aborted) ++out_.aborts[std::string(rig::name(sequencer->abort()))];
    }

    // --- invariants ---

    void check_disk() {
        disk_->pause(true);
        for (const std::string& what : audit_.check()) violated(what);
        disk_->pause(false);
        for (const std::string& what : account_.check(audit_.rows())) violated(what);
        if (out_.violations.empty())
            for (const std::string& what : recomputed_.check(audit_.rows())) violated(what);
    }

    void check_numbers() {
        for (std::int64_t number = 1; number <= planned_; ++number) {
            const auto& rows = audit_.rows();
            const auto is = [number](const auto& row) { return row.attempt.number == number && row.state == rig::record::RowState::finished; };
            if (std::none_of(rows.begin(), rows.end(), is))
                violated(fmt::format("the campaign has ended, and maneuver {} was left out", number));
            else
                ++out_.finished;
        }
    }

    const CellSetup& setup_;
    const CellTrace& trace_;
    wear::Generator draw_;
    SimulatedClock clock_;
    Time period_;
    const antiskid::can::Layout& layout_;
    std::int64_t planned_;
    rig::Plan plan_;
    std::int64_t max_sound_attempts_;  // one per maneuver, and those that a fault still spoils after its end
    std::shared_ptr<const SimulatedDisk> disk_;
    std::shared_ptr<AllocationGate> gate_;
    CampaignAudit audit_;
    EnergyAccount account_;
    RecomputedFigures recomputed_;
    FaultyBus bus_;
    FaultyBus::End &at_rig_, &at_controller_, &bridge_send_bus_, &bridge_receive_bus_;
    rig::modbus::RegisterBank bank_;
    LineState line_;
    plc::ServedRig rig_;
    ServeNode serving_;
    CellJudge judge_;
    FaultTimeline faults_;

    ControllerProgram controller_;
    Time controller_away_{};

    std::unique_ptr<BridgeProgram> bridge_;
    Time bridge_away_{}, loop_away_{}, next_poll_{}, next_step_{};
    Time down_{};  // downtime of the next fault that ends the bridge
    std::filesystem::path attempt_folder_;
    std::int64_t sound_attempts_ = 0;
    CellOutcome out_;

    unsigned open_ = 0;  // interlocks
    Phase phase_ = Phase::finished;
    bool frozen_ = false;  // the PLC's registers
    bool complete_ = false;
};

}  // namespace

CellOutcome run_cell_campaign(const CellSetup& setup, std::uint64_t seed, std::span<const PlannedFault> faults, const CellTrace& trace) {
    return CellCampaign(setup, seed, faults, trace).run();
}

}  // namespace plant_sim::simulation
