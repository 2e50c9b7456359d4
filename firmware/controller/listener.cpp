#include "firmware/controller/listener.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/can/roles.hpp"
#include "firmware/control/estimator.hpp"
#include "firmware/control/monitor.hpp"
#include "firmware/host/frame_intake.hpp"
#include "firmware/host/pacer.hpp"

namespace antiskid::controller {

namespace {

/// The controller's eyes without its hand.
class Senses {
  public:
    explicit Senses(const control::Config& config)
        : estimator_(config), monitor_(config), safe_Pa_(control::valve_pressure_Pa(config.valve, config.valve.safe_current_mA)) {}

    [[nodiscard]] control::FaultSet step(const control::Sensors& sensors, control::Time now) {
        (void)estimator_.update(sensors, safe_Pa_);
        return monitor_.check(sensors, estimator_, {}, now);
    }
    [[nodiscard]] float wheel_radps() const { return estimator_.wheel_reading().speed_radps; }
    [[nodiscard]] float flywheel_radps() const { return estimator_.flywheel_reading().speed_radps; }

  private:
    control::Estimator estimator_;
    control::Monitor monitor_;
    float safe_Pa_;
};

void note(Reception& reception, control::FaultSet faults, const Senses& senses) {
    for (std::size_t i = 0; i < control::kFaultCount; ++i)
        if (faults.contains(static_cast<control::Fault>(i))) ++reception.fault_periods[i];
    reception.wheel_radps = std::max(reception.wheel_radps, std::abs(senses.wheel_radps()));
    reception.flywheel_radps = std::max(reception.flywheel_radps, std::abs(senses.flywheel_radps()));
    const float pressure = reception.sensors.pressure.pressure_Pa;
    if (std::abs(pressure) > std::abs(reception.pressure_Pa)) reception.pressure_Pa = pressure;
}

}  // namespace

std::size_t ListeningBus::receive(std::span<can::Frame> frames) {
    const std::size_t count = bus_.receive(frames);
    for (const can::Frame& frame : frames.first(count))
        for (const can::Role role : can::kToRig)
            if (layout_[role].bound && layout_[role].id == frame.id) ++controller_frames_;
    return count;
}

Reception listen(const controller::ControllerSetup& setup, can::Bus& bus, host::Clock& clock, const control::Time duration,
                 const std::atomic<bool>& stop) {
    ListeningBus overheard(bus, setup.layout);
    can::ControllerPort port(setup.layout, setup.period);
    host::FrameIntake intake(overheard, port);
    host::TimerPacer pacer(clock, setup.period, intake);
    Senses senses(setup.control);
    Reception reception;
    const control::Time began = clock.now();
    for (auto wake = pacer.next(stop); wake; wake = pacer.next(stop)) {
        port.note_link(overheard.status());
        reception.sensors = port.sensors();
        const control::FaultSet faults = senses.step(reception.sensors, wake->now);
        port.clear_one_shots();
        ++reception.periods;
        reception.missed_periods += wake->skipped;
        reception.latency.add(wake->latency);
        reception.work.add(clock.now() - wake->woke);
        if (wake->now - began >= Reception::kSettle) note(reception, faults, senses);
        if (wake->now - began >= duration) break;
    }
    for (const can::Role role : can::kToController) reception.stats[static_cast<std::size_t>(role)] = port.stats(role);
    reception.controller_frames = overheard.controller_frames();
    reception.link = overheard.status();
    return reception;
}

}  // namespace antiskid::controller
