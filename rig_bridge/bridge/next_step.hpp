/// What an abort cause or a fault of the controller means in plain words, and what to do next: one table, shown when the abort appears, and
/// printed in docs/user/next_steps.md. Pure.
#pragma once

#include <string>
#include <string_view>

#include "firmware/control/types.hpp"
#include "rig_bridge/sequencer/sequencer.hpp"

namespace rig {

struct NextStep {
    std::string_view happened;
    std::string_view next;
};

[[nodiscard]] NextStep next_step(sequencer::Abort abort);
[[nodiscard]] NextStep next_step(antiskid::control::Fault fault);

/// What a phase waits for to be over; what a phase_timeout lacked.
[[nodiscard]] std::string_view awaited(sequencer::Phase phase);

/// For the terminal, at the abort that ended `phase`: cause, what it means, what to do; with controller_fault each of `faults` on a line of
/// its own.
[[nodiscard]] std::string advice(sequencer::Abort abort, sequencer::Phase phase, antiskid::control::FaultSet faults);

}  // namespace rig
