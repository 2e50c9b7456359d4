/// Owning libmodbus contexts, and texts for its error numbers.
#pragma once

#include <modbus/modbus.h>

#include <chrono>
#include <memory>
#include <string>

#include "firmware/host/settings/file_descriptor.hpp"

namespace rig::modbus {

/// Asks a thread to end, interrupting its waits.
class StopSignal {
  public:
    /// Throws std::system_error if no file descriptor is left.
    StopSignal();

    void raise() const;
    /// Waits up to `time`; true as soon as it is raised.
    [[nodiscard]] bool wait_for(std::chrono::nanoseconds time) const;
    /// Readable once raised, for poll().
    [[nodiscard]] int descriptor() const { return event_.get(); }

  private:
    settings::FileDescriptor event_;
};

struct ModbusFree {
    void operator()(modbus_t* context) const { modbus_free(context); }
};
using ModbusContext = std::unique_ptr<modbus_t, ModbusFree>;

/// "illegal data address", "Connection refused".
[[nodiscard]] std::string modbus_error(int number);

}  // namespace rig::modbus
