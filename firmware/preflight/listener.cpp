#include "firmware/preflight/listener.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/can/roles.hpp"
#include "firmware/control/estimator.hpp"
#include "firmware/control/monitor.hpp"
#include "firmware/host/frame_intake.hpp"
#include "firmware/host/pacer.hpp"

namespace antiskid::preflight {

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

void note(Heard& heard, control::FaultSet faults, const Senses& senses) {
    for (std::size_t i = 0; i < control::kFaultCount; ++i)
        if (faults.contains(static_cast<control::Fault>(i))) ++heard.fault_periods[i];
    heard.wheel_radps = std::max(heard.wheel_radps, std::abs(senses.wheel_radps()));
    heard.flywheel_radps = std::max(heard.flywheel_radps, std::abs(senses.flywheel_radps()));
    const float pressure = heard.sensors.pressure.pressure_Pa;
    if (std::abs(pressure) > std::abs(heard.pressure_Pa)) heard.pressure_Pa = pressure;
}

}  // namespace

std::size_t OverheardBus::receive(std::span<can::Frame> frames) {
    const std::size_t count = bus_.receive(frames);
    for (const can::Frame& frame : frames.first(count))
        for (const can::Role role : can::kToRig)
            if (layout_[role].bound && layout_[role].id == frame.id) ++controller_frames_;
    return count;
}

Heard listen(const rt::Setup& setup, can::Bus& bus, rt::Clock& clock, const control::Time duration, const std::atomic<bool>& stop) {
    OverheardBus overheard(bus, setup.layout);
    can::ControllerPort port(setup.layout, setup.period);
    rt::FrameIntake intake(overheard, port);
    rt::TimerPacer pacer(clock, setup.period, intake);
    Senses senses(setup.control);
    Heard heard;
    const control::Time began = clock.now();
    for (auto wake = pacer.next(stop); wake; wake = pacer.next(stop)) {
        port.note_link(overheard.status());
        heard.sensors = port.sensors();
        const control::FaultSet faults = senses.step(heard.sensors, wake->now);
        port.clear_one_shots();
        ++heard.periods;
        heard.missed_periods += wake->skipped;
        heard.latency.add(wake->latency);
        heard.work.add(clock.now() - wake->woke);
        if (wake->now - began >= Heard::kSettle) note(heard, faults, senses);
        if (wake->now - began >= duration) break;
    }
    for (const can::Role role : can::kToController) heard.stats[static_cast<std::size_t>(role)] = port.stats(role);
    heard.controller_frames = overheard.controller_frames();
    heard.link = overheard.status();
    return heard;
}

}  // namespace antiskid::preflight
