/// A controller on a bench: encoders, pressure and a maneuver command whose motion is written by the test, a valve that obeys eq. (6).
/// The wheel does what it is told, whatever the brake does: the bench is for states and faults, not for braking.
#pragma once

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include "firmware/control/controller.hpp"
#include "tests/control/fixed_config.hpp"
#include "tests/control/shaft.hpp"
#include "tests/control/valve_truth.hpp"

namespace control_test {

class Bench {
  public:
    explicit Bench(const antiskid::control::Config& c = fixed_config())
        : config(c),
          controller(c),
          wheel_(static_cast<double>(c.wheel.encoder.teeth)),
          flywheel_(static_cast<double>(c.flywheel.encoder.teeth)),
          valve_(static_cast<double>(c.valve.natural_frequency_radps), static_cast<double>(c.valve.damping), static_cast<double>(c.valve.delay_s)),
          period_(std::llround(static_cast<double>(c.period_s) * 1e6) * 1000) {
        sensors.maneuver.law = antiskid::control::Law::wheel_slip;
        sensors.maneuver.slip_reference = 0.07F;
        sensors.maneuver.deceleration_mps2 = 3.0F;
    }

    /// One period: the motion goes on, the sensors report, `tamper` spoils what the controller sees of it.
    antiskid::control::Command step() {
        const double h = static_cast<double>(config.period_s);
        now += period_;
        valve_.hold(static_cast<double>(antiskid::control::valve_pressure_Pa(config.valve, command.current_mA)), h);
        wheel_.turn_to(v_mps * (1.0 - slip) / radius_m, h);
        flywheel_.turn_to(v_mps / static_cast<double>(config.flywheel.radius_m), h);
        wheel_.report(sensors.wheel, now);
        flywheel_.report(sensors.flywheel, now);
        sensors.pressure.received = now;
        sensors.pressure.pressure_Pa = static_cast<float>(valve_.pressure_Pa());
        sensors.maneuver.received = now;
        sensors.rig_heartbeat_received = now;
        antiskid::control::Sensors seen = sensors;
        if (tamper) tamper(seen);
        command = controller.step(seen, now);
        return command;
    }
    void steps(const int count) {
        for (int i = 0; i < count; ++i) static_cast<void>(step());
    }
    void seconds(const double s) { steps(static_cast<int>(std::lround(s / static_cast<double>(config.period_s)))); }

    /// Aircraft in the air at 40 m/s, wheel at rest; ends in standby.
    void to_standby() {
        v_mps = 40.0;
        slip = 1.0;
        seconds(0.3);
        expect(antiskid::control::State::standby);
    }
    /// Armed, touched down, spun up, rolling freely.
    void to_armed() {
        to_standby();
        sensors.maneuver.arm = true;
        static_cast<void>(step());
        sensors.maneuver.weight_on_wheels = true;
        spin_up();
        seconds(0.5);
        expect(antiskid::control::State::armed);
    }
    /// Braking with a demand of 6 MPa, the wheel at the slip reference.
    void to_braking(const antiskid::control::Law law = antiskid::control::Law::wheel_slip) {
        to_armed();
        sensors.maneuver.law = law;
        sensors.maneuver.demand_Pa = 6e6F;
        sensors.maneuver.current_mA = 12.0F;
        slip = 0.07;  // below free_slip: it stays when the brake is off
        seconds(0.4);
        expect(antiskid::control::State::braking);
    }
    /// The wheel from rest to free rolling in 30 ms.
    void spin_up() {
        for (int i = 0; i < 30; ++i) {
            slip = 1.0 - (i + 1) / 30.0;
            seconds(1e-3);
        }
    }

    [[nodiscard]] double valve_Pa() const { return valve_.pressure_Pa(); }
    [[nodiscard]] antiskid::control::Time period() const { return period_; }

    antiskid::control::Config config;
    antiskid::control::Controller controller;
    antiskid::control::Sensors sensors;
    antiskid::control::Command command;
    antiskid::control::Time now{};
    double v_mps = 0.0;
    double slip = 1.0;  ///< of the wheel, 1: at rest
    double radius_m = 0.324;
    std::function<void(antiskid::control::Sensors&)> tamper;

  private:
    void expect(const antiskid::control::State state) const {
        // In standby the names of an earlier fault may still stand.
        if (command.state != state || (state != antiskid::control::State::standby && !command.faults.empty()))
            throw std::logic_error("the bench is in state " + std::to_string(static_cast<int>(command.state)) + ", faults " +
                                   std::to_string(command.faults.bits()));
    }

    Shaft wheel_;
    Shaft flywheel_;
    ValveTruth valve_;
    antiskid::control::Time period_;
};

}  // namespace control_test
