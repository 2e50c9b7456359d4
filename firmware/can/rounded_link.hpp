/// Connects rig and controller in process without encoding frames, for studies: every value is rounded, limited, rolled over and repeated exactly as
/// the frames of `layout` would. No loss, delay or protection. Freestanding.
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

    /// Call once a step: the controller's inputs after the frames due at this step, all received at `now`.
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
