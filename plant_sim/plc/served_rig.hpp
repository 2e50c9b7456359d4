/// The whole rig as its users meet it: the plant of Rig, the machines around it, and the PLC that runs them. Any number of maneuvers, one
/// after the other; the brake remembers. Behind CAN and Modbus it is `virtual-rig serve`; in process it is as fast as the plant.
///
///     plc::ServedRig rig(loaded, plc::load_served_rig(config, loaded), seed);
///     for (;;) {
///         rig.command(registers);                    // SI values of the holding registers, watchdog and commit among them
///         rig.advance(valve_current_mA);             // one period
///         use(rig.measured(), rig.sample());
///     }
///
/// At the start everything is at rest (the flywheel turns where the options say so) and off, the brake at ambient temperature, the PLC ready. It
/// scans every kScan_s: a command acts, and measured values change, at the next scan. Touchdown, where the sledge reaches its contact position,
/// begins a maneuver for the brake: its mean friction is asked of it, and its curve over v begins at the rim speed that is left when the wheel has
/// spun up. Lift-off ends the maneuver: the brake has taken its energy then.
///
/// One object, one thread. Same seed, same calls: same values.
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
    /// None: always the friction of the loaded rig. A brake that is worn out so far that its friction curve would fall to zero keeps
    /// rig::min_mean_friction().
    std::optional<wear::WearingBrake> brake{};
    double period_s = 1e-3;    ///< of advance(), a whole multiple of 1 ms
    double watchdog_s = 0.5;   ///< of the bridge, in rig time: the register map's
    double map_version = 1.0;  ///< as measured
    double rim_mps = 0.0;      ///< of the flywheel at the start
};

class ServedRig {
  public:
    static constexpr double kScan_s = 0.01;

    /// Throws std::invalid_argument for a period that is no whole number of milliseconds.
    ServedRig(const rig::LoadedRig& loaded, ServedRigOptions options, std::uint64_t seed);

    /// The holding registers as they stand now. Judged at the next scan, see VirtualPlc.
    void command(const rig::CommandedValues& values) { commanded_ = values; }
    /// Bit i forces rig::Interlock i open; 0: all as the machines are. Without hydraulics the supply reads no pressure, too; the sledge
    /// goes back by its accumulator. The brake has a supply of its own.
    void open_interlocks(unsigned mask) { forced_open_ = mask; }

    /// One period with the valve current held.
    void advance(double valve_current_mA);

    /// The brake as it is after maneuvers of another object, e.g. those of a ledger. Between two maneuvers only. Throws
    /// std::invalid_argument as WearingBrake does, and where the rig has none.
    void take_up(const wear::BrakeState& state);

    /// Whether pass_idle() may be used: sledge back, wheel at rest, no pressure, drive and its orders off.
    [[nodiscard]] bool idle() const;
    /// Where idle(): `seconds` at once in closed form, whole periods of it, at no valve current; flywheel coasting, brake cooling. The
    /// bridge is taken to have kept its watchdog moving; measured values are those at the end. Elsewhere nothing happens. Returns the time
    /// that has passed.
    double pass_idle(double seconds);
    /// How long an idle rig needs to cool its brake to `to_C`; infinite where it never will.
    [[nodiscard]] double cooling_time_s(double to_C) const { return options_.machinery.thermal.cooling_time_s(temperature_C_, to_C); }

    [[nodiscard]] double time_s() const { return rig_.time_s(); }
    [[nodiscard]] const rig::MeasuredValues& measured() const { return measured_; }
    /// Wheel, flywheel and pressure now; the rest is not the rig's to say.
    [[nodiscard]] antiskid::can::RigSample sample() const;

    // The truth behind the gauges.
    [[nodiscard]] const plant::Rig& rig() const { return rig_; }
    [[nodiscard]] const VirtualPlc& plc() const { return plc_; }
    [[nodiscard]] bool wheel_on_rim() const { return on_rim_; }
    [[nodiscard]] double sledge_m() const { return sledge_m_; }
    [[nodiscard]] double brake_temperature_C() const { return temperature_C_; }
    /// Of the brake, what it took before this object included.
    [[nodiscard]] double cumulative_energy_J() const { return (brake_ ? brake_->state().c_e_J : 0.0) + rig_.wheel().energy_brake_J - accounted_J_; }
    /// After the last maneuver that ended.
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
