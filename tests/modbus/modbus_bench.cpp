/// Server and client of this project for tests by stock ones.
///
///     modbus_bench serve                serves config/registers.toml; prints port and pseudo-terminal as JSON, then reads lines:
///                                       `NAME VALUE` sets a measured value, `orders` prints what the PLC is told, one scan later
///     modbus_bench ask ADDRESS NAME=VALUE...
///                                       commands that, prints the snapshot after the PLC has applied it
#include <algorithm>
#include <exception>
#include <iostream>
#include <sstream>
#include <string>

#include "firmware/host/settings/json.hpp"
#include "rig_bridge/modbus/client.hpp"
#include "tests/modbus/plc_stub.hpp"

namespace {

using settings::Json;

template <typename Quantity, std::size_t N>
Quantity by_name(const std::string& name) {
    for (std::size_t i = 0; i < N; ++i) {
        if (rig::name(static_cast<Quantity>(i)) == name) return static_cast<Quantity>(i);
    }
    throw std::invalid_argument("no quantity '" + name + "'");
}

template <typename Quantity, typename Values>
Json named(const Values& values) {
    Json object;
    for (std::size_t i = 0; i < values.size(); ++i) object[std::string(rig::name(static_cast<Quantity>(i)))] = values[i];
    return object;
}

int serve() {
    const auto map = stub::shipped_map();
    stub::Plc plc(map, {.rtu = true});
    std::cout << Json{{"port", plc.server().port()}, {"rtu", plc.server().rtu_path()}} << std::endl;
    for (std::string line; std::getline(std::cin, line);) {
        std::istringstream words(line);
        std::string name;
        double value = 0.0;
        words >> name >> value;
        if (name == "orders") {
            plc.settle();
            const auto commands = plc.commands();
            auto object = named<rig::Commanded>(commands.commanded);
            object["open_interlocks"] = commands.open_interlocks;
            std::cout << object << std::endl;
        } else {
            plc.set(by_name<rig::Measured, rig::kMeasuredCount>(name), value);
        }
    }
    return 0;
}

int ask(const std::vector<std::string>& arguments) {
    rig::CommandedValues wanted{};
    for (std::size_t i = 1; i < arguments.size(); ++i) {
        const auto equals = arguments[i].find('=');
        const auto q = by_name<rig::Commanded, rig::kCommandedCount>(arguments[i].substr(0, equals));
        rig::at(wanted, q) = std::stod(arguments[i].substr(equals + 1));
    }
    rig::modbus::ModbusClient client(stub::shipped_map(), rig::modbus::parse_plc_address(arguments.at(0)));
    const bool applied = stub::eventually([&] {
        client.command(wanted);
        return client.snapshot().command == rig::modbus::CommandState::applied;
    });
    const auto now = client.snapshot();
    auto object = named<rig::Measured>(now.values);
    object["error"] = now.error;
    object["commit"] = now.commit;
    object["good"] = std::all_of(now.quality.begin(), now.quality.end(), [](auto quality) { return quality == rig::ValueQuality::good; });
    std::cout << object << std::endl;
    return applied ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const std::vector<std::string> arguments(argv + 1, argv + argc);
        if (arguments.size() == 1 && arguments[0] == "serve") return serve();
        if (arguments.size() >= 2 && arguments[0] == "ask") return ask({arguments.begin() + 1, arguments.end()});
        std::cerr << "usage: modbus_bench serve | ask ADDRESS NAME=VALUE...\n";
        return 2;
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
