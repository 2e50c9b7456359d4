/// Rig and controller joined without bytes, for studies in process: every value is rounded, limited and
/// rolled over exactly as the frames of `layout` would do it, and comes as often. No loss, no delay, no
/// protection. Freestanding; tens of ns a step.
///
/// Proven equal to RigPort -> frames -> ControllerPort by test (CAN-070).
#pragma once

#include <cstdint>

#include "firmware/can/layout.hpp"
#include "firmware/can/rig_sample.hpp"
#include "firmware/can/schedule.hpp"
#include "firmware/can/sensor_decoder.hpp"
#include "firmware/control/types.hpp"

namespace antiskid::can {

class RoundedLink {
  public:
    /// `layout` must outlive the link. `step` > 0 is the period at which sense() is called.
    RoundedLink(const Layout& layout, control::Time step);
    RoundedLink(const Layout&& layout, control::Time step) = delete;

    /// Once a step: what the controller knows after the frames that are due at this step, all received at
    /// `now`.
    [[nodiscard]] const control::Sensors& sense(const RigSample& sample, control::Time now);

    /// The valve current as the rig's valve driver decodes it.
    [[nodiscard]] float current_mA(const control::Command& command) const {
        return static_cast<float>(layout_.valve_current_mA.rounded(static_cast<double>(command.current_mA)));
    }

  private:
    const Layout& layout_;
    Schedule schedule_;
    control::Sensors sensors_;
    SpeedDecoder wheel_;
    SpeedDecoder flywheel_;
    std::uint32_t step_index_ = 0;
};

}  // namespace antiskid::can
