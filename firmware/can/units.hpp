/// The units that a signal may have on the bus, and their size in the controller's unit of that quantity.
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
    double factor = 1.0;  ///< one of it, in the controller's unit

    bool operator==(const Unit&) const = default;
};

/// By any of its usual spellings (rpm, 1/min); none when unknown. The empty text is the unit 1.
[[nodiscard]] std::optional<Unit> find_unit(std::string_view spelling);

/// "bar, kPa, mbar, MPa, Pa, psi": what a binding may say for `quantity`.
[[nodiscard]] std::string units_of(Quantity quantity);

}  // namespace antiskid::can
