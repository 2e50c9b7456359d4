/// Units that a signal may have on the bus, and their conversion to the controller's units.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace antiskid::can {

enum class Quantity : std::uint8_t {
    ratio,          ///< 1
    angular_speed,  ///< rad/s
    speed,          ///< m/s
    acceleration,   ///< m/s2
    pressure,       ///< Pa
    current,        ///< mA
    force,          ///< N
    torque,         ///< N m
    time,           ///< ns
    temperature,    ///< degrees Celsius
};

struct Unit {
    Quantity quantity = Quantity::ratio;
    double factor = 1.0;  ///< size of one unit in the controller's unit

    bool operator==(const Unit&) const = default;
};

/// Finds a unit by any usual spelling (rpm, 1/min); none if unknown. The empty text is the unit 1.
[[nodiscard]] std::optional<Unit> find_unit(std::string_view spelling);

/// "bar, kPa, mbar, MPa, Pa, psi": the units that a binding may use for `quantity`.
[[nodiscard]] std::string units_of(Quantity quantity);

}  // namespace antiskid::can
