#include "plant_sim/simulation/cell_campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "firmware/can/controller_port.hpp"
#include "firmware/control/controller.hpp"
#include "firmware/host/seconds.hpp"
#include "plant_sim/serve_node.hpp"
#include "plant_sim/simulation/bridge_program.hpp"
#include "plant_sim/simulation/faulty_bus.hpp"
#include "plant_sim/simulation/permission.hpp"
#include "plant_sim/simulation/simulated_line.hpp"
#include "rig_bridge/bridge/next_step.hpp"

namespace plant_sim::simulation {

using antiskid::can::Frame;
using antiskid::can::Role;
using antiskid::control::kNever;
using antiskid::control::Time;
using antiskid::host::seconds;
using rig::Phase;

namespace {

Time duration(double s) {
    return Time(std::llround(s * 1e9));
}

class SimulatedClock final : public antiskid::host::Clock {
  public:
    [[nodiscard]] Time now() override { return now_; }
    [[nodiscard]] Time time() const { return now_; }
    void sleep_until(Time /*deadline*/) override {}
    void pass(Time period) { now_ += period; }

  private:
    Time now_{1'000'000'000};
};

class CellCampaign {
  public:
    CellCampaign(const CellSetup& setup, std::uint64_t seed, std::span<const PlannedFault> faults, const CellTrace& trace)
        : setup_(setup),
          trace_(trace),
          draw_(wear::generator_of(seed, 1)),
          period_(duration(static_cast<double>(setup.controller.period_s))),
          layout_(setup.bridge.layout),
          planned_(static_cast<std::int64_t>(1 + draw_() % 2)),
          bus_(draw_, [this](const auto& end, const Frame& frame, bool damaged) { witness(end, frame, damaged); }),
          at_rig_(bus_.connect()),
          at_controller_(bus_.connect()),
          bridge_sends_(bus_.connect()),
          bridge_hears_(bus_.connect()),
          permission_(layout_),
          valve_(layout_),
          bank_(setup.bridge.map),
          rig_(setup.bridge.scenario.rig, setup.machinery, seed),
          serving_(rig_, layout_, at_rig_, clock_, period_, [this](plc::ServedRig& rig) { exchange(rig); }),
          top_mps_(rig::top_speed_mps(plan())) {
        for (const PlannedFault& fault : faults) faults_.push_back({.planned = fault});
    }

    CellOutcome run() {
        constexpr double kLongest_s = 3000.0;
        // Begun while nothing fails: one for each maneuver, and what a fault still spoils after its end.
        const std::int64_t max_sound = planned_ + 3 * static_cast<std::int64_t>(faults_.size()) + 3;
        while (number_ <= planned_ && out_.violations.empty()) {
            period();
            if (sound_attempts_ > max_sound || seconds(clock_.now()) > kLongest_s)
                violated(
                    fmt::format("the campaign does not come to its end: {} of {} maneuvers in {} attempts", out_.finished, planned_, out_.attempts));
        }
        if (out_.violations.empty() && out_.finished != planned_) violated(fmt::format("{} of {} maneuvers were run", out_.finished, planned_));
        out_.simulated_s = seconds(clock_.now());
        for (const std::uint64_t frames : bus_.struck()) out_.frames_struck += frames;
        for (const std::uint64_t requests : line_.struck) out_.requests_struck += requests;
        return std::move(out_);
    }

  private:
    struct Fault {
        PlannedFault planned;
        std::optional<Time> begins{};
        bool active = false;
        bool over = false;
    };

    void tell(const std::string& line) const {
        if (trace_) trace_(fmt::format("{:9.3f} s  {}", seconds(clock_.time()), line));
    }
    void violated(const std::string& what) {
        tell("VIOLATION: " + what);
        out_.violations.push_back(what);
    }
    [[nodiscard]] rig::Plan plan() const {
        constexpr double kSpeed_mps = 10.0;
        rig::Plan plan = setup_.bridge.scenario.mean;
        plan.speed_mps = kSpeed_mps;
        return plan;
    }

    void period() {
        clock_.pass(period_);
        bus_.set_time(clock_.now());
        line_.now = clock_.now();
        time_faults();
        serving_.period();
        controller_turn();
        bridge_turn();
        check();
    }

    void exchange(plc::ServedRig& rig) {
        if (!frozen_) rig.command(bank_.exchange(rig.measured()).commanded);
        rig.open_interlocks(setup_.interlocks_trip ? open_ : 0U);
    }

    // --- what fails ---

    void time_faults() {
        bool changed = false;
        for (Fault& fault : faults_) {
            if (!fault.begins || fault.over) continue;
            const Time now = clock_.now();
            const bool active = now >= *fault.begins && now < *fault.begins + duration(fault.planned.lasts_s);
            if (active == fault.active) continue;
            changed = true;
            fault.active = active;
            fault.over = !active;
            tell(active ? "begins: " + text(fault.planned)
                        : "is over: " + std::string(kCellFaultNames.at(static_cast<std::size_t>(fault.planned.fault))));
            if (active) begin(fault.planned);
        }
        if (changed) apply();
    }

    /// What happens once.
    void begin(const PlannedFault& fault) {
        ++out_.begun.at(static_cast<std::size_t>(fault.fault));
        const Time until = clock_.now() + duration(fault.lasts_s);
        switch (fault.fault) {
            case CellFault::controller_killed:
                controller_.reset();
                controller_away_ = until;
                break;
            case CellFault::controller_stopped:
                controller_away_ = until;
                break;
            case CellFault::bridge_killed:
                end_bridge();
                bridge_away_ = until;
                break;
            case CellFault::bridge_stopped:
                bridge_away_ = until;
                break;
            case CellFault::bridge_hangs:
                loop_away_ = until;
                break;
            default:
                break;
        }
    }

    /// What lasts.
    void apply() {
        for (FaultyBus::End* const end : {&at_rig_, &at_controller_, &bridge_sends_, &bridge_hears_}) end->calm();
        line_.shares.fill(0.0);
        line_.reachable = true;
        frozen_ = false;
        unsigned open = 0;
        std::array<bool, kPartyNames.size()> up{true, true, true};
        for (const Fault& fault : faults_) {
            if (!fault.active) continue;
            const PlannedFault& p = fault.planned;
            if (p.fault < CellFault::off_bus) end_of(p.party).strike(static_cast<FrameFault>(p.fault), p.share);
            if (p.fault == CellFault::off_bus) up.at(static_cast<std::size_t>(p.party)) = false;
            if (p.fault >= CellFault::requests_lost && p.fault <= CellFault::requests_doubled)
                line_.shares.at(static_cast<std::size_t>(p.fault) - static_cast<std::size_t>(CellFault::requests_lost)) = p.share;
            if (p.fault == CellFault::plc_unreachable) line_.reachable = false;
            if (p.fault == CellFault::plc_frozen) frozen_ = true;
            if (p.fault == CellFault::interlock_open) open |= 1U << static_cast<unsigned>(p.interlock);
        }
        if (open != open_) opened_ = clock_.now();
        open_ = open;
        at_rig_.set_up(up[0]);
        at_controller_.set_up(up[1]);
        bridge_sends_.set_up(up[2]);
        bridge_hears_.set_up(up[2]);
    }

    FaultyBus::End& end_of(Party party) { return party == Party::rig ? at_rig_ : party == Party::controller ? at_controller_ : bridge_hears_; }

    // --- the programs ---

    void controller_turn() {
        if (clock_.now() < controller_away_) {
            ++missed_;
            return;
        }
        if (!controller_) {
            controller_.emplace(setup_.controller);
            port_.emplace(layout_, period_);
            permission_.forget();
            missed_ = 0;
        }
        std::array<Frame, 64> frames{};
        for (std::size_t count = frames.size(); count == frames.size();) {
            count = at_controller_.receive(frames);
            for (std::size_t i = 0; i < count; ++i) port_->accept(frames[i]);
        }
        port_->note_link(at_controller_.status());
        port_->note_missed_periods(std::exchange(missed_, 0U));
        const antiskid::control::Command command = controller_->step(port_->sensors(), clock_.now());
        port_->clear_one_shots();
        std::array<Frame, antiskid::can::ControllerPort::kMaxFrames> due{};
        const auto all = std::span(due).first(port_->due_frames(command, due));
        if (at_controller_.send_all(all) == 0 && !all.empty()) port_->note_command_unsent();
    }

    void end_bridge() {
        line_.reachable = false;  // it dies without a word
        bridge_.reset();
        sequencer_.reset();
        bridge_hears_.set_up(false);
        if (!setup_.goes_on) ++number_;
        apply();
    }

    void start_bridge() {
        const auto now = [this] { return clock_.now(); };
        bridge_ = std::make_unique<BridgeProgram>(setup_.bridge, bridge_sends_, bridge_hears_,
                                                  std::make_unique<SimulatedLine>(bank_, setup_.bridge.map.link, line_, draw_), now);
        permission_.forget();
        introduced_ = clock_.now() + duration(0.5);
        next_step_ = clock_.now();
        next_poll_ = line_.busy_until = Time{};
        tell("the bridge starts");
    }

    void bridge_turn() {
        const Time now = clock_.now();
        if (now < bridge_away_) return;
        if (!bridge_) start_bridge();
        poll();
        if (now < next_step_ || now < loop_away_) return;
        next_step_ = now + rig::bridge::Node::kStep;
        const rig::bridge::Moment& moment = bridge_->step(sequencer_ ? &*sequencer_ : nullptr, {.number = number_, .reset = setup_.resets});
        if (sequencer_)
            follow(moment);
        else if (now >= introduced_)
            begin_attempt();
    }

    void poll() {
        if (clock_.now() < std::max(next_poll_, line_.busy_until)) return;
        next_poll_ = clock_.now() + setup_.bridge.map.link.poll;
        if (!setup_.loop_proves_life) bridge_->prove_alive();
        bridge_->poll();
    }

    void begin_attempt() {
        ++out_.attempts;
        if (std::none_of(faults_.begin(), faults_.end(), [](const Fault& fault) { return fault.active; })) ++sound_attempts_;
        sequencer_.emplace(plan());
        phase_ = Phase::finished;
        touchdowns_ = rig_.maneuvers();
        tell(fmt::format("maneuver {}, attempt {}", number_, out_.attempts));
    }

    void follow(const rig::bridge::Moment& moment) {
        if (moment.outputs.phase != phase_) {
            phase_ = moment.outputs.phase;
            tell(fmt::format("{}{}", rig::name(phase_), phase_ == Phase::aborting ? fmt::format(": {}", rig::name(sequencer_->abort())) : ""));
            for (Fault& fault : faults_) {
                if (!fault.begins && fault.planned.phase == phase_ && out_.attempts >= fault.planned.attempt)
                    fault.begins = clock_.now() + duration(fault.planned.after_s);
            }
        }
        if (!sequencer_->over()) return;
        if (sequencer_->phase() == Phase::finished)
            finish();
        else
            abort();
        sequencer_.reset();
        introduced_ = clock_.now() + duration(0.5);
    }

    // --- what must hold ---

    void finish() {
        ++number_;
        ++out_.finished;
        if (rig_.maneuvers() != touchdowns_ + 1)
            violated(fmt::format("a maneuver is finished, and the wheel touched down {} times", rig_.maneuvers() - touchdowns_));
        if (rig_.rig().wheel().v_mps > 1.0) violated("a maneuver is finished, and the flywheel was not stopped");
    }

    void abort() {
        const rig::Abort cause = sequencer_->abort();
        ++out_.aborts[std::string(rig::name(cause))];
        if (cause == rig::Abort::none || rig::bridge::next_step(cause).happened.empty()) violated("an abort without a cause in words");
        if (sequencer_->safe_end_seen() && (rig_.sledge_m() > 0.05 || rig_.rig().pressure_Pa() > 2.0 * plan().pressure_gone_Pa))
            violated(
                fmt::format("a safe end was seen, with the sledge at {:.2f} m and {:.1f} MPa", rig_.sledge_m(), rig_.rig().pressure_Pa() * 1e-6));
    }

    void witness(const FaultyBus::End& end, const Frame& frame, bool damaged) {
        if (damaged) return;
        if (&end == &at_controller_) permission_.accept(frame);
        if (&end != &at_rig_ || valve_.accept(frame) != Role::valve) return;
        // The command may have been on its way for as long as frames are late.
        const Time longest = duration(setup_.permission_s) + FaultyBus::kMaxLate + 3 * period_;
        if (valve_.view().controller.current_mA > setup_.controller.valve.safe_current_mA + 0.01F && frame.received - permission_.granted() > longest)
            violated(fmt::format("{:.2f} mA, {:.3f} s after the last permission", valve_.view().controller.current_mA,
                                 seconds(frame.received - permission_.granted())));
    }

    void check() {
        const plc::MachineCommands& machines = rig_.plc().commands();
        const bool on = machines.drive || machines.advance || machines.load;
        const Time now = clock_.now();
        if (open_ != 0 && on && now - opened_ > duration(2.0 * plc::ServedRig::kScan_s))
            violated("drive, sledge or load is on with an interlock open");
        const bool loop_lives = bridge_ && now >= bridge_away_ && now >= loop_away_;
        const bool plc_answers = line_.reachable && !frozen_;
        if (loop_lives && plc_answers) bridge_seen_ = now;
        // A loop that was away sees it at its next step.
        if (plc_answers || !loop_lives) plc_answered_ = now;
        if ((controller_ && now >= controller_away_) || !loop_lives) controller_lived_ = now;
        if (sequencer_ && phase_ >= Phase::spin_up && phase_ <= Phase::standstill) {
            const Time step = 2 * rig::bridge::Node::kStep + setup_.bridge.map.link.poll;
            if (now - plc_answered_ > duration(setup_.limits.registers_s) + step) violated("the bridge goes on without a PLC");
            if (now - controller_lived_ > duration(setup_.limits.controller_s) + step) violated("the bridge goes on without a controller");
        }
        // A client whose main loop hangs moves its watchdog for the user time-out; the PLC takes its time-out, and both their rounds.
        const rig::RegisterMap& map = setup_.bridge.map;
        const Time until_trip = map.bridge_timeout + map.link.user_timeout + map.link.poll + duration(2.0 * plc::ServedRig::kScan_s);
        if (on && now - bridge_seen_ > until_trip) violated("drive, sledge or load is on without a bridge");
        if (rig_.rig().wheel().v_mps > top_mps_ + 0.1) violated(fmt::format("the flywheel runs at {:.2f} m/s", rig_.rig().wheel().v_mps));
        // Valve and line let go within half a second.
        const Time longest = duration(setup_.permission_s + 0.5) + FaultyBus::kMaxLate + ServeNode::kDriverWatchdog;
        if (rig_.rig().pressure_Pa() > 2.0 * plan().pressure_gone_Pa && now - permission_.granted() > longest)
            violated(
                fmt::format("{:.1f} MPa, {:.3f} s after the last permission", rig_.rig().pressure_Pa() * 1e-6, seconds(now - permission_.granted())));
    }

    const CellSetup& setup_;
    const CellTrace& trace_;
    wear::Generator draw_;
    SimulatedClock clock_;
    Time period_;
    const antiskid::can::Layout& layout_;
    std::int64_t planned_;
    FaultyBus bus_;
    FaultyBus::End &at_rig_, &at_controller_, &bridge_sends_, &bridge_hears_;
    Permission permission_;
    antiskid::can::Observer valve_;
    rig::modbus::RegisterBank bank_;
    LineState line_;
    plc::ServedRig rig_;
    ServeNode serving_;
    double top_mps_;

    std::optional<antiskid::control::Controller> controller_;
    std::optional<antiskid::can::ControllerPort> port_;
    Time controller_away_{};
    std::uint32_t missed_ = 0;

    std::unique_ptr<BridgeProgram> bridge_;
    std::optional<rig::Sequencer> sequencer_;
    Time bridge_away_{}, loop_away_{}, introduced_{}, next_poll_{}, next_step_{}, bridge_seen_{}, plc_answered_{}, controller_lived_{};
    std::int64_t number_ = 1;
    Phase phase_ = Phase::idle;
    std::uint32_t touchdowns_ = 0;
    std::int64_t sound_attempts_ = 0;

    std::vector<Fault> faults_;
    bool frozen_ = false;
    unsigned open_ = 0;
    Time opened_{};
    CellOutcome out_;
};

}  // namespace

CellOutcome run_cell_campaign(const CellSetup& setup, std::uint64_t seed, std::span<const PlannedFault> faults, const CellTrace& trace) {
    return CellCampaign(setup, seed, faults, trace).run();
}

}  // namespace plant_sim::simulation
