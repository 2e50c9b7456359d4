/// A rig on the in-process bus: sends its frames in every period, at rest unless the test moves it, and obeys the valve.
#pragma once

#include <algorithm>
#include <array>
#include <functional>

#include "firmware/control/valve_model.hpp"
#include "tests/host/loop_bench.hpp"

namespace controller_test {

namespace can = antiskid::can;
namespace host = antiskid::host;
namespace controller = antiskid::controller;
namespace control = antiskid::control;

class RigAtRest {
  public:
    RigAtRest()
        : setup(host_test::default_setup()),
          ear(hub.connect()),
          end(hub.connect()),
          port_(setup.layout, setup.period),
          valve_(setup.control.valve, setup.control.period_s, {}) {
        clock.on_sleep = [this](control::Time) { period(); };
    }

    controller::ControllerSetup setup;
    host_test::StepClock clock;
    can::Loopback hub;
    can::Loopback::End& ear;  ///< where the check listens
    can::Loopback::End& end;  ///< the rig's
    can::RigSample sample;
    float pressure_offset_Pa = 0.0F;
    float valve_gain = 1.0F;                         ///< of pressure over what the map says
    std::function<bool(can::Frame& frame)> disturb;  ///< false: the frame is not sent
    std::function<void(int period)> each;
    std::vector<can::Frame> reception;  ///< by the rig
    float largest_Pa = 0.0F;

    void stand_still() { clock.on_sleep = nullptr; }

  private:
    void period() {
        if (each) each(periods_);
        ++periods_;
        hub.set_time(clock.now());
        take_commands();
        const float wanted = valve_gain * control::valve_pressure_Pa(setup.control.valve, port_.controller().current_mA);
        valve_.update(wanted, 0.0F, false);
        sample.pressure_Pa = valve_.now().pressure_Pa + pressure_offset_Pa;
        largest_Pa = std::max(largest_Pa, sample.pressure_Pa);
        std::array<can::Frame, can::RigPort::kMaxFrames> frames;
        const std::size_t count = port_.due_frames(sample, frames);
        for (can::Frame& frame : std::span(frames).first(count))
            if (!disturb || disturb(frame)) end.send(frame);
    }
    void take_commands() {
        std::array<can::Frame, 64> batch;
        for (std::size_t n = end.receive(batch); n > 0; n = end.receive(batch))
            for (const can::Frame& frame : std::span(batch).first(n)) {
                port_.accept(frame);
                reception.push_back(frame);
            }
    }

    can::RigPort port_;
    control::ValveModel valve_;
    int periods_ = 0;
};

}  // namespace controller_test
