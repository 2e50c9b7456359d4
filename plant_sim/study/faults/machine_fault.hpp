/// Faults of the controller's own machine: its loop, its interface, its clock.
#pragma once

#include "firmware/control/types.hpp"
#include "plant_sim/study/faults/catalogue.hpp"

namespace faults {

/// - overrun: a share of the periods is missed; if negative, 1 to 300 in a row by strength, again and again with as many good ones
/// - bus_off: nothing comes or goes; if negative, for the share of the time, 20 ms by 20 ms
/// - clock_step: the clock of loop and frames jumps by 0.1 ms to 10 s forwards; if negative, only the stamps of the frames, forwards or
///   back
class MachineFault {
  public:
    explicit MachineFault(const Fault& fault) : fault_(fault) {}

    struct Effect {
        bool misses_period = false;
        bool bus_off = false;
        antiskid::control::Time clock{};   ///< that the machine's clock has jumped
        antiskid::control::Time stamps{};  ///< that the frames' stamps are off it
    };
    /// Once a period.
    [[nodiscard]] Effect effect(bool active, rig::Random& random);

  private:
    Fault fault_;
    std::int64_t periods_ = 0;  // of the fault
    bool off_ = false;
    antiskid::control::Time clock_{};  // a clock that has jumped stays there
};

}  // namespace faults
