// Fields that end below what the rig needs.
#include "firmware/can/load_layout.hpp"
#include "firmware/host/settings/error.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

using namespace antiskid::can;

namespace {

constexpr RequiredRange kRequired{
    .pressure_Pa = 20.7e6, .current_mA = 40.0, .wheel = {}, .flywheel = {}, .vertical_N = {}, .longitudinal_N = {}, .brake_torque_Nm = {}};

RequiredRange requiring(void (*set)(RequiredRange&)) {
    RequiredRange required;
    set(required);
    return required;
}

Layout with(const std::string& from, const std::string& to, const RequiredRange& required = kRequired) {
    const can_test::TempDir dir;
    return load_layout(dir.write("a.dbc", can_test::replaced(can_test::contents("config/antiskid.dbc"), from, to)),
                       dir.write("a.toml", can_test::contents("config/antiskid_binding.toml")), required);
}

}  // namespace

TEST_CASE("a field that ends below the rig's pressure or current is refused with both numbers", "[CAN-040]") {
    const std::string pressure = "SG_ Pressure : 16|16@1+ (500,0) [0|32767500] \"Pa\"";
    CHECK_NOTHROW(with(pressure, pressure));
    CHECK_NOTHROW(with(pressure, "SG_ Pressure : 16|16@1+ (500,0) [0|20700000] \"Pa\""));
    for (const char* narrow : {"SG_ Pressure : 16|16@1+ (5,0) [0|327675] \"Pa\"", "SG_ Pressure : 16|16@1+ (500,0) [0|327675] \"Pa\""}) {
        CHECK_THROWS_WITH(with(pressure, narrow), ContainsSubstring("a.toml:") && ContainsSubstring("pressure.signal") &&
                                                      ContainsSubstring("ends at 327") &&
                                                      ContainsSubstring("too narrow for this rig: it must reach 2.07e+07 Pa"));
        CHECK_NOTHROW(with(pressure, narrow, {}));
    }
    const std::string demand = "SG_ Demand : 16|16@1+ (500,0) [0|32767500] \"Pa\"";
    CHECK_THROWS_WITH(with(demand, "SG_ Demand : 16|16@1+ (5,0) [0|327675] \"Pa\""), ContainsSubstring("maneuver.demand.signal"));
    CHECK_THROWS_WITH(with(pressure, pressure, requiring([](RequiredRange& r) { r.current_mA = 52.0; })),
                      ContainsSubstring("maneuver.current.signal") && ContainsSubstring("it must reach 52 mA"));
}

TEST_CASE("load cells that end below what they may read are refused, at both ends", "[CAN-040]") {
    const std::string same = "BO_ 400 LoadCells";
    CHECK_NOTHROW(with(same, same, requiring([](RequiredRange& r) {
                           r.vertical_N.max = r.longitudinal_N.max = 65.5e3;
                           r.longitudinal_N.min = -65.5e3;
                           r.brake_torque_Nm = {.min = -5e3, .max = 32.7e3};
                       })));
    CHECK_THROWS_WITH(
        with(same, same, requiring([](RequiredRange& r) { r.vertical_N.max = 100e3; })),
        ContainsSubstring("load_cells.vertical.signal") && ContainsSubstring("ends at 65535 N") && ContainsSubstring("it must reach 100000 N"));
    CHECK_THROWS_WITH(with(same, same, requiring([](RequiredRange& r) { r.longitudinal_N.min = -80e3; })),
                      ContainsSubstring("load_cells.longitudinal.signal") && ContainsSubstring("begins at -65536 N"));
    CHECK_THROWS_WITH(with(same, same, requiring([](RequiredRange& r) { r.brake_torque_Nm.max = 40e3; })),
                      ContainsSubstring("load_cells.brake_torque.signal"));
}

TEST_CASE("an edge counter that may roll over unseen is refused", "[CAN-040]") {
    const std::string same = "BO_ 400 LoadCells";
    CHECK_NOTHROW(with(same, same, requiring([](RequiredRange& r) { r.wheel.edges = r.flywheel.edges = 65535.0; })));
    CHECK_THROWS_WITH(with(same, same, requiring([](RequiredRange& r) { r.wheel.edges = 65536.0; })),
                      ContainsSubstring("wheel.edge_count") && ContainsSubstring("65536 edges"));
    CHECK_THROWS_WITH(with(same, same, requiring([](RequiredRange& r) { r.flywheel.edges = 1e5; })), ContainsSubstring("flywheel.edge_count"));
}

TEST_CASE("a reported speed that ends below the encoder's highest is refused", "[CAN-040]") {
    const auto load = [](double wheel_radps) {
        RequiredRange required;
        required.wheel.radps = wheel_radps;
        return load_layout("config/foreign.dbc", "config/foreign_binding.toml", required);
    };
    CHECK_NOTHROW(load(400.0));
    CHECK_THROWS_WITH(load(450.0),
                      ContainsSubstring("wheel.speed.signal") && ContainsSubstring("too narrow for this rig: it must reach 4297.18 rpm"));
}
