/// Rig, PLC, controller and sequencer in one process, faster than real time: the same code as in the three programs, joined without bytes.
/// Figures come from the meter, on what the sensors said and the bus would have carried.
///
///     endurance::TestCell cell(scenario, controller, layout, plc::load_served_rig(config, plc::Bench::endurance), seed);
///     const endurance::Outcome outcome = cell.run(rig::plan(scenario, seed, number));
///
/// The controller steps every control period, the sequencer every kSequencer_s. While the brake cools on a rig where nothing moves, time
/// passes in one piece and the controller sleeps.
#pragma once

#include <functional>

#include "firmware/can/layout.hpp"
#include "firmware/can/rounded_link.hpp"
#include "firmware/control/controller.hpp"
#include "plant_sim/plc/served_rig.hpp"
#include "rig_bridge/bridge/live_speed.hpp"
#include "rig_bridge/bridge/reset_request.hpp"
#include "rig_bridge/bridge/translate.hpp"
#include "rig_bridge/record/meter.hpp"
#include "rig_bridge/rig/scenario.hpp"

namespace endurance {

struct Outcome {
    rig::Phase phase = rig::Phase::idle;  ///< finished or aborted
    rig::Abort abort = rig::Abort::none;
    rig::record::Figures figures;
    antiskid::control::FaultSet faults;  ///< the controller's, latched at any time
};

/// One control period: what rig and bridge said (load cells and phase among it), and what the controller answered.
struct Period {
    double time_s;  ///< of the rig
    const antiskid::can::RigSample& sample;
    const antiskid::control::Command& command;
    double current_mA;  ///< as the valve driver decodes it, held to the next period
};
using PeriodObserver = std::function<void(const Period&)>;

class TestCell {
  public:
    static constexpr double kSequencer_s = 0.01;

    /// `layout` must outlive the cell. The rig's period becomes the controller's. Throws std::invalid_argument where that is none of whole
    /// milliseconds.
    TestCell(const rig::Scenario& scenario, const antiskid::control::Config& controller, const antiskid::can::Layout& layout,
             plc::ServedRigOptions options, std::uint64_t seed);

    /// One maneuver from idle to its end, as the bridge runs it: a brake that the one before left hot cools first, and a tripped PLC is
    /// reset where every interlock is good. `observe` sees every period from then on that is not slept through.
    [[nodiscard]] Outcome run(const rig::Plan& plan, const PeriodObserver& observe = {});

    /// The rig, e.g. to open an interlock or to look at the truth.
    [[nodiscard]] plc::ServedRig& rig() { return rig_; }
    [[nodiscard]] double time_s() const { return rig_.time_s(); }
    /// What the controller has lived through: it sleeps while the brake cools.
    [[nodiscard]] antiskid::control::Time controller_time() const { return now_; }

  private:
    void measure(rig::Phase phase, const antiskid::can::RigSample& sample, rig::record::Meter& meter) const;
    [[nodiscard]] rig::Inputs sequencer_inputs() const;
    /// As the bridge's client does it: a new commit number where anything differs; the watchdog always moves.
    void command(const rig::Outputs& outputs, bool reset);
    void period(const rig::Outputs& outputs, rig::record::Meter& meter, const PeriodObserver& observe);
    void cool(const rig::Plan& plan);
    void await_cold_brake(const rig::Plan& plan);

    rig::Scenario scenario_;
    const antiskid::can::Layout& layout_;
    antiskid::control::Time period_;
    std::int64_t periods_per_step_;
    plc::ServedRig rig_;
    antiskid::control::Controller controller_;
    antiskid::can::RoundedLink link_;
    rig::bridge::LiveSpeed wheel_, flywheel_;
    rig::CommandedValues commanded_{};
    std::uint16_t commit_ = 0, watchdog_ = 0;
    double committed_s_ = 0.0;
    rig::bridge::ResetRequest reset_;
    antiskid::control::Time now_{};       // of the controller
    antiskid::control::Command command_;  // its newest
    antiskid::control::FaultSet faults_;
};

}  // namespace endurance
