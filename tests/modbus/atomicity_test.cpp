// Nobody sees half of a command, or half of a measurement.
#include <modbus/modbus.h>

#include <algorithm>
#include <array>
#include <bit>
#include <memory>
#include <random>

#include "tests/catch.hpp"
#include "tests/modbus/plc_stub.hpp"

using rig::at;
using rig::Commanded;
using rig::Measured;

namespace {

using Context = std::unique_ptr<modbus_t, void (*)(modbus_t*)>;

Context connected(std::uint16_t port) {
    Context context(modbus_new_tcp("127.0.0.1", port), [](modbus_t* c) {
        modbus_close(c);
        modbus_free(c);
    });
    modbus_set_response_timeout(context.get(), 60, 0);
    if (modbus_connect(context.get()) != 0) context.reset();
    return context;
}

}  // namespace

TEST_CASE("Multi-register commands are seen whole, under fire", "[BRG-020]") {
    const auto map = stub::shipped_map();
    rig::modbus::ModbusServer server(map, {});
    constexpr int kCommands = 2000;
    std::atomic<bool> wrong{false};
    std::atomic<bool> done{false};

    // Writes speed, base and lift of command k in three requests in any order, then commit k.
    std::thread writer([&] {
        const auto link = connected(server.port());
        std::mt19937 random(1);
        for (int k = 1; k <= kCommands && link != nullptr; ++k) {
            const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(k));
            const std::array words{static_cast<std::uint16_t>(bits >> 16U), static_cast<std::uint16_t>(bits)};
            std::array<int, 3> addresses{5, 7, 9};
            std::shuffle(addresses.begin(), addresses.end(), random);
            for (const int address : addresses)
                if (modbus_write_registers(link.get(), address, 2, words.data()) != 2) wrong = true;
            if (modbus_write_register(link.get(), 11, static_cast<std::uint16_t>(k)) != 1) wrong = true;
        }
        if (link == nullptr) wrong = true;
        done = true;
    });
    // Measured values of one scan are all the same number; a reader asks for all of them at once.
    std::thread reader([&] {
        const auto link = connected(server.port());
        std::array<std::uint16_t, 8> words{};
        while (!done && link != nullptr) {
            if (modbus_read_input_registers(link.get(), 12, 8, words.data()) != 8) wrong = true;
            for (std::size_t i = 2; i < words.size(); ++i)
                if (words[i] != words[i - 2]) wrong = true;
        }
        if (link == nullptr) wrong = true;
    });

    rig::MeasuredValues measured{};
    double scan = 0.0;
    double newest = 0.0;
    int seen = 0;
    while (!done || newest < kCommands) {
        scan = scan >= 30'000.0 ? 0.0 : scan + 1.0;
        for (const auto q : {Measured::loading_force_N, Measured::vertical_load_N, Measured::longitudinal_force_N, Measured::brake_torque_Nm})
            at(measured, q) = scan;
        const auto commands = server.exchange(measured).commanded;
        const double k = at(commands, Commanded::commit);
        if (at(commands, Commanded::flywheel_speed_mps) != k || at(commands, Commanded::load_base_N) != k ||
            at(commands, Commanded::load_lift_Ns2pm2) != k || k < newest)
            wrong = true;
        if (k != newest) ++seen;
        newest = k;
        if (wrong && done) break;
        std::this_thread::yield();
    }
    writer.join();
    reader.join();
    CHECK_FALSE(wrong.load());
    CHECK(newest == kCommands);
    CHECK(seen > 10);
}
