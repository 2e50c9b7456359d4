/// libmodbus contexts with an owner, and its error numbers as words.
#pragma once

#include <modbus/modbus.h>

#include <chrono>
#include <memory>
#include <string>

#include "firmware/host/settings/file_descriptor.hpp"

namespace rig::modbus {

/// One thread tells another to end, also out of a wait.
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

struct ModbusFree {
    void operator()(modbus_t* context) const { modbus_free(context); }
};
using ModbusContext = std::unique_ptr<modbus_t, ModbusFree>;

/// "illegal data address", "Connection refused".
[[nodiscard]] std::string modbus_error(int number);

}  // namespace rig::modbus
