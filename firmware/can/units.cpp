#include "firmware/can/units.hpp"

#include <array>
#include <numbers>

namespace antiskid::can {

namespace {

struct UnitName {
    std::string_view text;
    Unit unit;
    bool usual = true;  ///< named when a message lists the units
};

using enum Quantity;

constexpr Unit kRpm{angular_speed, std::numbers::pi / 30.0};
constexpr Unit kMicrosecond{time, 1e3};

// psi: 4.4482216152605 N on 0.0254 m squared (exact definitions of pound-force and inch); knot: 1852 m in an
// hour.
constexpr std::array kUnitNames{
    UnitName{"1", {ratio, 1.0}},
    UnitName{"", {ratio, 1.0}, false},
    UnitName{"-", {ratio, 1.0}, false},
    UnitName{"%", {ratio, 0.01}},
    UnitName{"rad/s", {angular_speed, 1.0}},
    UnitName{"deg/s", {angular_speed, std::numbers::pi / 180.0}},
    UnitName{"rpm", kRpm},
    UnitName{"RPM", kRpm, false},
    UnitName{"1/min", kRpm, false},
    UnitName{"U/min", kRpm, false},
    UnitName{"m/s", {speed, 1.0}},
    UnitName{"km/h", {speed, 1.0 / 3.6}},
    UnitName{"kn", {speed, 1852.0 / 3600.0}},
    UnitName{"m/s2", {acceleration, 1.0}},
    UnitName{"m/s^2", {acceleration, 1.0}, false},
    UnitName{"m/s\xC2\xB2", {acceleration, 1.0}, false},
    UnitName{"g", {acceleration, 9.80665}},
    UnitName{"Pa", {pressure, 1.0}},
    UnitName{"kPa", {pressure, 1e3}},
    UnitName{"MPa", {pressure, 1e6}},
    UnitName{"mbar", {pressure, 1e2}},
    UnitName{"bar", {pressure, 1e5}},
    UnitName{"psi", {pressure, 4.4482216152605 / (0.0254 * 0.0254)}},
    UnitName{"uA", {current, 1e-3}},
    UnitName{"mA", {current, 1.0}},
    UnitName{"A", {current, 1e3}},
    UnitName{"N", {force, 1.0}},
    UnitName{"daN", {force, 10.0}},
    UnitName{"kN", {force, 1e3}},
    UnitName{"Nm", {torque, 1.0}},
    UnitName{"N.m", {torque, 1.0}, false},
    UnitName{"N m", {torque, 1.0}, false},
    UnitName{"kNm", {torque, 1e3}},
    UnitName{"ns", {time, 1.0}},
    UnitName{"us", kMicrosecond},
    UnitName{"\xC2\xB5s", kMicrosecond, false},
    UnitName{"\xB5s", kMicrosecond, false},  // the micro sign in Latin-1, the usual encoding of a DBC
    UnitName{"ms", {time, 1e6}},
    UnitName{"s", {time, 1e9}},
    UnitName{"degC", {temperature, 1.0}},
    UnitName{"C", {temperature, 1.0}, false},
    UnitName{"\xC2\xB0"
             "C",
             {temperature, 1.0},
             false},
    UnitName{"\xB0"
             "C",
             {temperature, 1.0},
             false},  // Latin-1
};

}  // namespace

std::optional<Unit> find_unit(std::string_view spelling) {
    for (const UnitName& known : kUnitNames) {
        if (known.text == spelling) return known.unit;
    }
    return std::nullopt;
}

std::string units_of(Quantity quantity) {
    std::string list;
    for (const UnitName& known : kUnitNames) {
        if (known.unit.quantity != quantity || !known.usual) continue;
        if (!list.empty()) list += ", ";
        list += known.text;
    }
    return list;
}

}  // namespace antiskid::can
