/// Address of a PLC.
#pragma once

#include <cstdint>
#include <string>
#include <variant>

namespace rig::modbus {

struct TcpServer {
    std::string address = "127.0.0.1";  ///< numeric IPv4
    std::uint16_t port = 502;
};
struct SerialDevice {
    std::string path;  ///< e.g. /dev/ttyUSB0; baud rate, parity and stop bits are the map's
};
using PlcAddress = std::variant<TcpServer, SerialDevice>;

/// "192.168.1.10:502", "192.168.1.10" (port 502), or a path that begins with '/'. Throws std::invalid_argument that
/// says what would be right.
[[nodiscard]] PlcAddress parse_plc_address(const std::string& text);
/// Resolves a host name, which may take seconds: "plc7:502" to "192.168.1.10:502". Throws std::invalid_argument for an unknown name.
[[nodiscard]] std::string numeric_plc_address(const std::string& text);
/// "Modbus TCP 192.168.1.10:502", "Modbus RTU /dev/ttyUSB0".
[[nodiscard]] std::string to_string(const PlcAddress& address);

}  // namespace rig::modbus
