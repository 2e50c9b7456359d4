/// One thread tells another to end, also out of a wait.
#pragma once

#include <chrono>

#include "firmware/host/settings/file_descriptor.hpp"

namespace rig::modbus {

class StopSignal {
  public:
    /// Throws std::system_error when the process has no descriptor left.
    StopSignal();

    void raise() const;
    /// Whether it was raised, at once or before `time` has passed.
    [[nodiscard]] bool wait_for(std::chrono::nanoseconds time) const;
    /// Readable once raised, for poll().
    [[nodiscard]] int descriptor() const { return event_.get(); }

  private:
    settings::FileDescriptor event_;
};

}  // namespace rig::modbus
