#include "firmware/can/units.hpp"

#include <array>
#include <numbers>

namespace antiskid::can {

namespace {

struct Spelling {
    std::string_view text;
    Unit unit;
    bool usual = true;  ///< named when a message lists the units
};

using enum Quantity;

constexpr Unit kRpm{angular_speed, std::numbers::pi / 30.0};
constexpr Unit kMicrosecond{time, 1e3};

// psi: 4.4482216152605 N on 0.0254 m squared (exact definitions of pound-force and inch); knot: 1852 m in an
// hour.
constexpr std::array kSpellings{
    Spelling{"1", {ratio, 1.0}},
    Spelling{"", {ratio, 1.0}, false},
    Spelling{"-", {ratio, 1.0}, false},
    Spelling{"%", {ratio, 0.01}},
    Spelling{"rad/s", {angular_speed, 1.0}},
    Spelling{"deg/s", {angular_speed, std::numbers::pi / 180.0}},
    Spelling{"rpm", kRpm},
    Spelling{"RPM", kRpm, false},
    Spelling{"1/min", kRpm, false},
    Spelling{"U/min", kRpm, false},
    Spelling{"m/s", {speed, 1.0}},
    Spelling{"km/h", {speed, 1.0 / 3.6}},
    Spelling{"kn", {speed, 1852.0 / 3600.0}},
    Spelling{"m/s2", {acceleration, 1.0}},
    Spelling{"m/s^2", {acceleration, 1.0}, false},
    Spelling{"m/s\xC2\xB2", {acceleration, 1.0}, false},
    Spelling{"g", {acceleration, 9.80665}},
    Spelling{"Pa", {pressure, 1.0}},
    Spelling{"kPa", {pressure, 1e3}},
    Spelling{"MPa", {pressure, 1e6}},
    Spelling{"mbar", {pressure, 1e2}},
    Spelling{"bar", {pressure, 1e5}},
    Spelling{"psi", {pressure, 4.4482216152605 / (0.0254 * 0.0254)}},
    Spelling{"uA", {current, 1e-3}},
    Spelling{"mA", {current, 1.0}},
    Spelling{"A", {current, 1e3}},
    Spelling{"N", {force, 1.0}},
    Spelling{"daN", {force, 10.0}},
    Spelling{"kN", {force, 1e3}},
    Spelling{"Nm", {torque, 1.0}},
    Spelling{"N.m", {torque, 1.0}, false},
    Spelling{"N m", {torque, 1.0}, false},
    Spelling{"kNm", {torque, 1e3}},
    Spelling{"ns", {time, 1.0}},
    Spelling{"us", kMicrosecond},
    Spelling{"\xC2\xB5s", kMicrosecond, false},
    Spelling{"\xB5s", kMicrosecond, false},  // the micro sign in Latin-1, the usual encoding of a DBC
    Spelling{"ms", {time, 1e6}},
    Spelling{"s", {time, 1e9}},
    Spelling{"degC", {temperature, 1.0}},
    Spelling{"C", {temperature, 1.0}, false},
    Spelling{"\xC2\xB0"
             "C",
             {temperature, 1.0},
             false},
    Spelling{"\xB0"
             "C",
             {temperature, 1.0},
             false},  // Latin-1
};

}  // namespace

std::optional<Unit> find_unit(std::string_view spelling) {
    for (const Spelling& known : kSpellings) {
        if (known.text == spelling) return known.unit;
    }
    return std::nullopt;
}

std::string units_of(Quantity quantity) {
    std::string list;
    for (const Spelling& known : kSpellings) {
        if (known.unit.quantity != quantity || !known.usual) continue;
        if (!list.empty()) list += ", ";
        list += known.text;
    }
    return list;
}

}  // namespace antiskid::can
