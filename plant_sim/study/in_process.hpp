/// One maneuver in one process: the real controller with the plant, connected through the CAN contract.
#pragma once

#include <functional>

#include "firmware/can/frame.hpp"
#include "firmware/can/layout.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/control/config.hpp"
#include "firmware/control/types.hpp"
#include "plant_sim/study/rig_session.hpp"

namespace study {

/// Connection of rig and controller.
enum class Link {
    rounded,  ///< values are rounded as in frames, without encoding; for studies
    frames,   ///< every frame is encoded, protected, checked and decoded
};

/// Called after each control period with the rig, the decoded status of the controller, and the current that acted.
using StepObserver = std::function<void(const RigSession&, const antiskid::can::ControllerView&, double current_mA)>;
/// Called with each frame on the bus, in the order and with the time stamps of lockstep.
using FrameObserver = std::function<void(const antiskid::can::Frame&)>;

struct RunResult {
    StopFigures figures;
    antiskid::control::FaultSet faults;  ///< all that the controller reported
    std::uint64_t frames_sent = 0;       ///< by the rig; 0 with Link::rounded
    std::uint64_t frames_received = 0;   ///< by the rig
    std::uint64_t steps = 0;
    bool came_to_rest = false;
    bool operator==(const RunResult&) const = default;
};

/// Runs a maneuver to its end. `layout` must outlive the call. Observers may be empty.
RunResult run_in_process(const antiskid::control::Config& controller, const antiskid::can::Layout& layout, const rig::RigParameters& rig,
                         const SessionOptions& options, Link link, const StepObserver& on_step = {}, const FrameObserver& on_frame = {});

}  // namespace study
