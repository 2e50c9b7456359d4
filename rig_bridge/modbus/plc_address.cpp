#include "rig_bridge/modbus/plc_address.hpp"

#include <arpa/inet.h>
#include <netdb.h>

#include <array>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "firmware/host/settings/number_in.hpp"

namespace rig::modbus {
namespace {

std::uint16_t parse_port(const std::string& text, const std::string& whole) {
    const auto port = settings::number_in<std::uint16_t>(text);
    if (!port || *port == 0) throw std::invalid_argument("PLC address '" + whole + "': '" + text + "' is no port, expected 1 to 65535");
    return *port;
}

}  // namespace

PlcAddress parse_plc_address(const std::string& text) {
    if (!text.empty() && text.front() == '/') return SerialDevice{text};
    const auto colon = text.find(':');
    TcpServer server{.address = text.substr(0, colon)};
    in_addr numeric{};
    if (::inet_pton(AF_INET, server.address.c_str(), &numeric) != 1)
        throw std::invalid_argument("PLC address '" + text +
                                    "': expected a numeric IPv4 address and port, e.g. 192.168.1.10:502, or a "
                                    "serial device, e.g. /dev/ttyUSB0");
    if (colon != std::string::npos) server.port = parse_port(text.substr(colon + 1), text);
    return server;
}

std::string numeric_plc_address(const std::string& text) {
    const std::string host = text.substr(0, text.find(':'));
    in_addr numeric{};
    if (host.empty() || host.front() == '/' || ::inet_pton(AF_INET, host.c_str(), &numeric) == 1) return text;
    addrinfo wanted{};
    wanted.ai_family = AF_INET;
    wanted.ai_socktype = SOCK_STREAM;
    addrinfo* found = nullptr;
    if (const int error = ::getaddrinfo(host.c_str(), nullptr, &wanted, &found); error != 0)
        throw std::invalid_argument("PLC address '" + text + "': " + ::gai_strerror(error) + "; expected HOST:PORT, e.g. 192.168.1.10:502");
    const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(found, &::freeaddrinfo);
    sockaddr_in address{};
    std::memcpy(&address, found->ai_addr, sizeof address);
    std::array<char, INET_ADDRSTRLEN> digits{};
    ::inet_ntop(AF_INET, &address.sin_addr, digits.data(), digits.size());
    return digits.data() + text.substr(host.size());
}

std::string to_string(const PlcAddress& address) {
    if (const auto* tcp = std::get_if<TcpServer>(&address)) return "Modbus TCP " + tcp->address + ":" + std::to_string(tcp->port);
    return "Modbus RTU " + std::get<SerialDevice>(address).path;
}

}  // namespace rig::modbus
