/// libmodbus contexts with an owner, and its error numbers as words.
#pragma once

#include <modbus/modbus.h>

#include <memory>
#include <string>

namespace rig::modbus {

struct ModbusFree {
    void operator()(modbus_t* context) const { modbus_free(context); }
};
using ModbusContext = std::unique_ptr<modbus_t, ModbusFree>;

/// "illegal data address", "Connection refused".
[[nodiscard]] std::string modbus_error(int number);

}  // namespace rig::modbus
