#include "plant_sim/simulation/controller_program.hpp"

#include <array>
#include <span>
#include <utility>

namespace plant_sim::simulation {

using antiskid::can::Frame;

void ControllerProgram::period(antiskid::control::Time now) {
    if (!controller_) {
        controller_.emplace(config_);
        port_.emplace(layout_, period_);
        missed_ = 0;
    }
    for (std::size_t count = frames_.size(); count == frames_.size();) {
        count = bus_.receive(frames_);
        for (std::size_t i = 0; i < count; ++i) port_->accept(frames_[i]);
    }
    port_->note_link(bus_.status());
    port_->note_missed_periods(std::exchange(missed_, 0U));
    const antiskid::control::Command command = controller_->step(port_->sensors(), now);
    port_->clear_one_shots();
    std::array<Frame, antiskid::can::ControllerPort::kMaxFrames> due{};
    const auto all = std::span(due).first(port_->due_frames(command, due));
    if (bus_.send_all(all) == 0 && !all.empty()) port_->note_command_unsent();
}

}  // namespace plant_sim::simulation
