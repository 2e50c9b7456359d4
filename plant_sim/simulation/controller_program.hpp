/// The controller's program without its thread and clock: each call is one period of its loop.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/can/bus.hpp"
#include "firmware/can/controller_port.hpp"
#include "firmware/control/controller.hpp"

namespace plant_sim::simulation {

class ControllerProgram {
  public:
    /// All arguments but `period` must outlive it. The program is not started.
    ControllerProgram(const antiskid::control::Config& config, const antiskid::can::Layout& layout, antiskid::control::Time period,
                      antiskid::can::Bus& bus)
        : config_(config), layout_(layout), period_(period), bus_(bus) {}

    void kill() { controller_.reset(); }
    [[nodiscard]] bool runs() const { return controller_.has_value(); }
    /// A period in which the program is stopped.
    void miss() { ++missed_; }
    /// A period in which the program runs; starts it if needed.
    void period(antiskid::control::Time now);

  private:
    const antiskid::control::Config& config_;
    const antiskid::can::Layout& layout_;
    antiskid::control::Time period_;
    antiskid::can::Bus& bus_;
    std::optional<antiskid::control::Controller> controller_;
    std::optional<antiskid::can::ControllerPort> port_;
    std::array<antiskid::can::Frame, 64> frames_{};  // not cleared for each period
    std::uint32_t missed_ = 0;
};

}  // namespace plant_sim::simulation
