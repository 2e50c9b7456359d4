// Fields that end below what the rig needs.
#include "firmware/can/load_layout.hpp"
#include "firmware/host/settings/error.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

using namespace antiskid::can;

namespace {

constexpr RequiredRange kRequired{.pressure_Pa = 20.7e6, .current_mA = 40.0};

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
    CHECK_THROWS_WITH(with(pressure, pressure, {.pressure_Pa = 0.0, .current_mA = 1e6}), ContainsSubstring("valve.current.signal"));
}
