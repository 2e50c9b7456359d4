/// Faults of the controller's computer: its loop, interface and clock.
#pragma once

#include "firmware/control/types.hpp"
#include "plant_sim/study/faults/catalogue.hpp"

namespace faults {

/// - overrun: a share of the periods is missed; if negative, runs of 1 to 300 missed periods, by strength, alternate with as many good ones
/// - bus_off: no frame is sent or received; if negative, for the share of the time, in units of 20 ms
/// - clock_step: the clock of loop and frames jumps forwards by 0.1 ms to 10 s; if negative, only the time stamps of the frames jump, forwards or
///   backwards
class MachineFault {
  public:
    explicit MachineFault(const Fault& fault) : fault_(fault) {}

    struct Effect {
        bool misses_period = false;
        bool bus_off = false;
        antiskid::control::Time clock{};   ///< step of the machine's clock
        antiskid::control::Time stamps{};  ///< offset of the frames' time stamps
    };
    /// Call once a period.
    [[nodiscard]] Effect effect(bool active, rig::Random& random);

  private:
    Fault fault_;
    std::int64_t periods_ = 0;  // of the fault
    bool off_ = false;
    antiskid::control::Time clock_{};  // a clock that has jumped stays so
};

}  // namespace faults
