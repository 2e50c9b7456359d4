/// Rig, PLC, controller and sequencer in one process, faster than real time: the code of the three programs, connected by function calls. The figures
/// come from the meter, which gets the sensor values as the bus would carry them.
///
///     endurance::TestCell cell(scenario, controller, layout, plc::load_served_rig(config, plc::Bench::endurance), seed);
///     const endurance::Outcome outcome = cell.run(rig::plan(scenario, seed, number));
///
/// The controller steps in each control period, the sequencer every kSequencer_s. While the brake cools on a rig at rest, time advances at once and
/// the controller does not step.
#pragma once

#include <functional>
#include <vector>

#include "firmware/can/layout.hpp"
#include "firmware/can/rounded_link.hpp"
#include "firmware/control/controller.hpp"
#include "plant_sim/plc/served_rig.hpp"
#include "rig_bridge/bridge/live_speed.hpp"
#include "rig_bridge/bridge/reset_request.hpp"
#include "rig_bridge/bridge/translate.hpp"
#include "rig_bridge/record/meter.hpp"
#include "rig_bridge/record/summary.hpp"
#include "rig_bridge/rig/acceptance.hpp"
#include "rig_bridge/rig/scenario.hpp"

namespace endurance {

struct Outcome {
    rig::Phase phase = rig::Phase::idle;  ///< finished or aborted
    rig::Abort abort = rig::Abort::none;
    rig::record::Figures figures;
    antiskid::control::FaultSet faults;  ///< all that the controller reported
    std::vector<std::string> warnings;   ///< of the figures
};

/// One control period: values sent by rig and bridge (load cells and phase included), and the controller's command.
struct Period {
    double time_s;  ///< of the rig
    const antiskid::can::RigSample& sample;
    const antiskid::control::Command& command;
    double current_mA;  ///< as decoded by the valve driver; held until the next period
};
using PeriodObserver = std::function<void(const Period&)>;

class TestCell {
  public:
    static constexpr double kSequencer_s = 0.01;

    /// `layout` must outlive the cell. The rig takes the controller's period. Throws std::invalid_argument if that is not a whole number of
    /// milliseconds.
    TestCell(const rig::Scenario& scenario, const antiskid::control::Config& controller, const antiskid::can::Layout& layout,
             plc::ServedRigOptions options, std::uint64_t seed);

    /// One maneuver from idle to its end, as the bridge runs it. Before it a hot brake cools, and a tripped PLC is reset if every interlock is good.
    /// `observe` is called for each period in which the controller steps.
    [[nodiscard]] Outcome run(const rig::Plan& plan, const PeriodObserver& observe = {});

    /// The rig, e.g. to open an interlock or to read true values.
    [[nodiscard]] plc::ServedRig& rig() { return rig_; }
    [[nodiscard]] double time_s() const { return rig_.time_s(); }
    /// The controller's time, without the periods in which the brake cooled.
    [[nodiscard]] antiskid::control::Time controller_time() const { return now_; }

  private:
    void measure(rig::Phase phase, const antiskid::can::RigSample& sample, rig::record::Meter& meter) const;
    [[nodiscard]] rig::Inputs sequencer_inputs() const;
    /// As the bridge's client does: a new commit number if a register differs; the watchdog always counts.
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

/// With the same verdicts as rig-bridge's. `head`: what was known before; its cumulative energy is that before this maneuver. `bands`: of the
/// scenario; empty: none.
[[nodiscard]] rig::record::Summary summary_of(const rig::record::Summary& head, const Outcome& outcome, const std::vector<rig::Band>& bands);

}  // namespace endurance
