/// The complete rig: the plant, the machines around it, and the PLC that controls them. It runs any number of maneuvers; the brake keeps its wear.
/// `virtual-rig serve` connects it to CAN and Modbus; in one process it is as fast as the plant.
///
///     plc::ServedRig rig(loaded, plc::load_served_rig(config, plc::Bench::endurance), seed);
///     for (;;) {
///         rig.command(registers);                    // SI values of the holding registers, watchdog and commit among them
///         rig.advance(valve_current_mA);             // one period
///         use(rig.measured(), rig.sample());
///     }
///
/// Initially all is off and at rest (the flywheel may turn, see the options), the brake is at ambient temperature, the PLC is ready. The PLC scans
/// every kScan_s: commands take effect, and measured values change, at the next scan. For the brake, touchdown (the sledge reaches its contact
/// position) starts a maneuver: the mean friction is computed from its state, and its curve over v starts at the rim speed at which the wheel has
/// spun up. Lift-off ends the maneuver and adds its energy to the brake's.
///
/// For one thread. The same seed and calls give the same values.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/can/rig_sample.hpp"
#include "plant_sim/model/rig.hpp"
#include "plant_sim/plc/machinery.hpp"
#include "plant_sim/plc/virtual_plc.hpp"
#include "rig_bridge/rig/load_rig.hpp"
#include "rig_bridge/rig/quantities.hpp"
#include "rig_bridge/wear/wearing_brake.hpp"

namespace plc {

struct ServedRigOptions {
    Machinery machinery;
    /// The brake in use; none: the friction is always that of the loaded rig. A brake so worn that its friction curve would fall to zero keeps
    /// rig::min_mean_friction().
    std::optional<wear::WearingBrake> brake{};
    double period_s = 1e-3;    ///< of advance(), a multiple of 1 ms
    double watchdog_s = 0.5;   ///< timeout of the bridge's watchdog in rig time, as in the register map
    double map_version = 1.0;  ///< measured value of the register map's version
    double rim_mps = 0.0;      ///< of the flywheel at the start
};

class ServedRig {
  public:
    static constexpr double kScan_s = 0.01;

    /// Throws std::invalid_argument if the period is not a whole number of milliseconds.
    ServedRig(const rig::LoadedRig& loaded, ServedRigOptions options, std::uint64_t seed);

    /// Sets the holding registers. They are judged at the next scan, see VirtualPlc.
    void command(const rig::CommandedValues& values) { commanded_ = values; }
    /// Bit i forces rig::Interlock i open; 0: none is forced. Without hydraulics the supply pressure reads 0 and the sledge moves back by its
    /// accumulator. The brake has a supply of its own.
    void open_interlocks(unsigned mask) { forced_open_ = mask; }

    /// Advances by one period with a constant valve current.
    void advance(double valve_current_mA);

    /// Sets the brake's state after maneuvers that another object ran, e.g. those of a ledger. Only between two maneuvers. Throws
    /// std::invalid_argument as WearingBrake does, and if the rig has no brake.
    void set_brake_state(const wear::BrakeState& state);

    /// Whether pass_idle() may be used: sledge back, wheel at rest, no pressure, drive off and not commanded on.
    [[nodiscard]] bool idle() const;
    /// Only if idle(), otherwise without effect: advances by the whole periods in `seconds` at once, in closed form, without valve current. The
    /// flywheel coasts and the brake cools; the bridge's watchdog counts as alive; measured values are those of the end. Returns the time advanced,
    /// s.
    double pass_idle(double seconds);
    /// Time that an idle rig needs to cool its brake to `to_C`; infinite if that is not above ambient.
    [[nodiscard]] double cooling_time_s(double to_C) const { return options_.machinery.thermal.cooling_time_s(temperature_C_, to_C); }

    [[nodiscard]] double time_s() const { return rig_.time_s(); }
    [[nodiscard]] const rig::MeasuredValues& measured() const { return measured_; }
    /// Present wheel, flywheel and pressure; the other members are not set.
    [[nodiscard]] antiskid::can::RigSample sample() const;

    // True values, without gauges.
    [[nodiscard]] const plant::Rig& rig() const { return rig_; }
    [[nodiscard]] const VirtualPlc& plc() const { return plc_; }
    [[nodiscard]] bool wheel_on_rim() const { return on_rim_; }
    [[nodiscard]] double sledge_m() const { return sledge_m_; }
    [[nodiscard]] double brake_temperature_C() const { return temperature_C_; }
    /// Energy of the brake, earlier use included.
    [[nodiscard]] double cumulative_energy_J() const { return (brake_ ? brake_->state().c_e_J : 0.0) + rig_.wheel().energy_brake_J - accounted_J_; }
    /// State after the last finished maneuver.
    [[nodiscard]] const std::optional<wear::WearingBrake>& brake() const { return brake_; }
    [[nodiscard]] std::uint32_t maneuvers() const { return maneuvers_; }  ///< touchdowns so far
    [[nodiscard]] double mean_friction() const { return rig_.parameters().mean_friction; }

  private:
    void scan();
    void run_machines();
    void move_sledge();
    void touch_down();
    void lift_off();
    void measure();
    [[nodiscard]] unsigned interlocks() const;

    ServedRigOptions options_;
    int steps_per_period_;
    plant::Rig rig_;
    VirtualPlc plc_;
    rig::Random gauge_noise_;
    std::optional<wear::WearingBrake> brake_;
    double accounted_J_ = 0.0;  // of the plant's brake energy, in brake_
    rig::CommandedValues commanded_{};
    rig::MeasuredValues measured_{};
    unsigned forced_open_ = 0;
    int steps_to_scan_ = 1;
    double sledge_m_ = 0.0;
    bool on_rim_ = false;
    double temperature_C_;
    double decay_;  // of the temperature over one plant step
    double energy_before_J_ = 0.0;
    std::uint32_t maneuvers_ = 0;
};

}  // namespace plc
