/// The bridge's side of the PLC without a link in between: commits what the sequencer wants, reads what the sequencer must know.
#pragma once

#include <cstdint>

#include "rig_bridge/registers/quantities.hpp"
#include "rig_bridge/sequencer/sequencer.hpp"

namespace endurance {

class DirectPlc {
  public:
    /// Longest time from a commit to its confirmation.
    static constexpr double kConfirm_s = 0.1;

    /// Once per step of the sequencer: the holding registers. A new commit number where anything differs; the watchdog always moves.
    [[nodiscard]] const rig::CommandedValues& command(const sequencer::Outputs& wanted, bool reset,
                                                      double now_s);

    /// What the PLC says, as Inputs: all but those of bus and controller.
    [[nodiscard]] sequencer::Inputs read(const rig::MeasuredValues& measured, double now_s) const;

  private:
    rig::CommandedValues commanded_{};
    std::uint16_t commit_ = 0;
    std::uint16_t watchdog_ = 0;
    double committed_s_ = 0.0;
};

}  // namespace endurance
