/// Meaning of each abort cause and controller fault in plain words, and what to do next: one table, shown with the abort and printed in
/// docs/user/next_steps.md. Pure.
#pragma once

#include <string>
#include <string_view>

#include "firmware/control/types.hpp"
#include "rig_bridge/rig/sequencer.hpp"

namespace rig::bridge {

struct NextStep {
    std::string_view happened;
    std::string_view next;
};

[[nodiscard]] NextStep next_step(rig::Abort abort);
[[nodiscard]] NextStep next_step(antiskid::control::Fault fault);

/// The condition that ends a phase, which was not met if the phase timed out.
[[nodiscard]] std::string_view awaited(rig::Phase phase);

/// Text for the terminal after an abort in `phase`: cause, meaning, what to do; with controller_fault one line for each of `faults`.
[[nodiscard]] std::string advice(rig::Abort abort, rig::Phase phase, antiskid::control::FaultSet faults);

}  // namespace rig::bridge
