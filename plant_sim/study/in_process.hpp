/// A whole maneuver in one process: the real controller against the plant, joined by the CAN contract.
#pragma once

#include <functional>

#include "firmware/can/frame.hpp"
#include "firmware/can/layout.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/control/config.hpp"
#include "firmware/control/types.hpp"
#include "plant_sim/study/rig_session.hpp"

namespace study {

/// What joins rig and controller.
enum class Link {
    rounded,  ///< values rounded as the frames would, no bytes: for studies
    frames,   ///< every frame packed, protected, checked and unpacked
};

/// Called after each control period with what the rig knows of the controller and the current that acted.
using StepObserver = std::function<void(const RigSession&, const antiskid::can::ControllerView&, double current_mA)>;
/// Called with every frame on the bus, in the order and with the time stamps of the lockstep run.
using FrameObserver = std::function<void(const antiskid::can::Frame&)>;

struct RunResult {
    StopFigures figures;
    antiskid::control::FaultSet faults;  ///< latched at any time during the run
    std::uint64_t frames_sent = 0;       ///< by the rig; 0 with Link::rounded
    std::uint64_t frames_received = 0;   ///< by the rig
    std::uint64_t steps = 0;
    bool came_to_rest = false;
    bool operator==(const RunResult&) const = default;
};

/// Runs to the end of the maneuver. `layout` must outlive the call. Observers may be empty.
RunResult run_in_process(const antiskid::control::Config& controller, const antiskid::can::Layout& layout, const rig::RigParameters& rig,
                         const SessionOptions& options, Link link, const StepObserver& on_step = {}, const FrameObserver& on_frame = {});

}  // namespace study
