/// Address and coding of each quantity in the PLC's registers, from config/registers.toml. Protocol addresses, from 0; input and holding registers
/// have separate address spaces.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "rig_bridge/rig/quantities.hpp"

namespace rig {

enum class RegisterType : std::uint8_t { u16, i16, u32, float32 };

/// Registers of one quantity: 1 for 16 bit, 2 for 32 bit.
[[nodiscard]] constexpr std::uint16_t width(RegisterType type) {
    return type == RegisterType::u16 || type == RegisterType::i16 ? 1 : 2;
}

/// Order of the two registers of a 32-bit quantity; within a register Modbus sends the high byte first.
enum class WordOrder : std::uint8_t {
    big,     ///< high word at the lower address, "ABCD"
    little,  ///< low word at the lower address, "CDAB"
};

/// value = scale raw + offset, in `unit`, within min to max.
struct Field {
    std::string name;
    std::uint16_t address = 0;
    RegisterType type = RegisterType::u16;
    double scale = 1.0;
    double offset = 0.0;
    double min = 0.0;
    double max = 0.0;
    std::string unit;
};

/// The client's times for this device.
struct LinkTimes {
    std::chrono::milliseconds poll{20};
    std::chrono::milliseconds connect_timeout{500};
    std::chrono::milliseconds response_timeout{200};
    std::chrono::milliseconds backoff_min{100};   ///< between a lost link and the next attempt; doubles ...
    std::chrono::milliseconds backoff_max{2000};  ///< ... up to this
    /// The client stops the bridge's watchdog if its caller has not called for this time.
    std::chrono::milliseconds user_timeout{100};
};

struct SerialLine {
    int baud = 115200;
    char parity = 'N';  ///< 'N', 'E' or 'O'
    int stop_bits = 1;
};

struct RegisterMap {
    std::uint16_t version = 0;
    WordOrder word_order = WordOrder::big;
    std::uint8_t unit_id = 1;
    std::chrono::milliseconds bridge_timeout{};  ///< the PLC trips after this time without a change of bridge_watchdog
    std::chrono::milliseconds plc_timeout{};     ///< the PLC counts as silent after this time without a change of plc_watchdog
    LinkTimes link;
    std::chrono::microseconds load_cells_late{};  ///< mean age of their readings in the registers when they are asked for
    SerialLine serial;
    std::array<Field, kMeasuredCount> measured;    ///< input registers, by Measured
    std::array<Field, kCommandedCount> commanded;  ///< holding registers, by Commanded
    /// Bit of each Interlock in the interlocks register. In MeasuredValues it is always bit i for Interlock i.
    std::array<std::uint8_t, kInterlockCount> interlock_bit{};
    Field open_interlocks;             ///< holding, virtual PLC only: set bits (as in the register) are forced open
    Field hang_s;                      ///< holding, virtual PLC only: delay of the answer to the next request
    std::optional<Field> bridge_turn;  ///< holding, virtual PLC only: lockstep_turn.hpp

    [[nodiscard]] const Field& field(Measured q) const { return measured[static_cast<std::size_t>(q)]; }
    [[nodiscard]] const Field& field(Commanded q) const { return commanded[static_cast<std::size_t>(q)]; }
};

/// Throws settings::Error naming file, line and key: unknown or missing quantities and keys, overlaps, addresses
/// outside 0 to 65535, ranges that the type cannot hold, units that are not the quantity's own, switches and counters
/// that are not plain u16.
[[nodiscard]] RegisterMap load_register_map(const std::filesystem::path& path);

}  // namespace rig
