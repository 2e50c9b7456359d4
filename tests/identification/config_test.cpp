/// What was identified, as configuration: the readers of plant and controller take it, whatever the digits.
#include <fstream>
#include <sstream>

#include "firmware/host/controller_config.hpp"
#include "plant_sim/study/identification/identified.hpp"
#include "rig_bridge/rig/load_rig.hpp"
#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"

using identification::Estimate;

namespace {

Estimate about(double value) {
    return {.value = value, .deviation = 0.01 * value, .low = 0.98 * value, .high = 1.02 * value};
}

identification::Identified found(double full_Pa) {
    identification::Identified f;
    f.valve.dead_zone_mA = about(3.1);
    f.valve.current_mA = {5.0, 20.0, 40.0};
    f.valve.pressure_Pa = {about(0.7e6), about(9.2e6), about(full_Pa)};
    f.valve.hysteresis_mA = about(0.25);
    f.valve.natural_frequency_Hz = about(19.0);
    f.valve.damping = about(0.75);
    f.valve.delay_s = about(5.5e-3);
    identification::FrictionFit snow;
    snow.surface = "snow";
    snow.coefficients = {{"c1", about(0.2)}, {"c2", about(90.0)}, {"c3", about(0.06)}};
    f.surfaces.push_back(snow);
    return f;
}

}  // namespace

TEST_CASE("a written configuration is read by plant and controller, whatever the last digit of a pressure", "[STUDY-100]") {
    const double full_Pa = GENERATE(20700152.4, 20700147.6, 20700149.96, 19999999.96);
    const TemporaryDirectory directory;
    const std::filesystem::path to = std::filesystem::path(directory / "config");
    identification::write_config(found(full_Pa), {.rig = "landing_gear.toml", .controller = "controller.toml"}, "config", to);
    CAPTURE(full_Pa);
    const antiskid::control::Config controller = antiskid::load_controller_config(to / "controller.toml");
    CHECK(static_cast<double>(controller.valve.full_pressure_Pa) == Approx(full_Pa).epsilon(1e-6));
    rig::ManeuverChoice choice;
    choice.surface = "snow";
    const rig::LoadedRig loaded = rig::load_rig(to, choice);
    CHECK(loaded.full_pressure_Pa == Approx(full_Pa).epsilon(1e-6));
    CHECK(loaded.rig.valve.hysteresis_mA == Approx(0.25));
    CHECK(loaded.rig.valve.delay_s == Approx(5.5e-3));
    CHECK(loaded.rig.surface.c2 == Approx(90.0));
    CHECK_THROWS_WITH(identification::write_config(found(full_Pa), {.rig = "landing_gear.toml", .controller = "controller.toml"}, "config", to),
                      ContainsSubstring("exists already"));
}

TEST_CASE("an identified magic formula takes the place of eq. (4), and the other way round", "[STUDY-100]") {
    const TemporaryDirectory directory;
    const identification::ConfigFiles files{.rig = "landing_gear.toml", .controller = "controller.toml"};
    identification::Identified magic = found(20.7e6);
    constexpr rig::MagicFormula kMagic{.B = 30.0, .C = 1.5, .D = 0.19, .E = -0.4};
    magic.surfaces[0].coefficients = {{"B", about(30.0)}, {"C", about(1.5)}, {"D", about(0.19)}, {"E", about(-0.4)}};
    magic.surfaces[0].curve.magic = kMagic;
    rig::ManeuverChoice choice;
    choice.surface = "snow";
    const std::filesystem::path first(directory / "magic"), second(directory / "eq_4");
    identification::write_config(magic, files, "config", first);
    const rig::Surface read = rig::load_rig(first, choice).rig.surface;
    REQUIRE(read.magic.has_value());
    CHECK(read.magic->B == kMagic.B);
    CHECK(read.magic->C == kMagic.C);
    CHECK(read.magic->D == kMagic.D);
    CHECK(read.magic->E == kMagic.E);
    identification::write_config(found(20.7e6), files, first, second);
    const rig::Surface back = rig::load_rig(second, choice).rig.surface;
    CHECK_FALSE(back.magic.has_value());
    CHECK(back.c1 == Approx(0.2));
    CHECK(back.c2 == Approx(90.0));
    CHECK(back.c3 == Approx(0.06));
    CHECK(rig::surface_names(second) == rig::surface_names("config"));
}

TEST_CASE("an identified contact pressure joins the file's brake, and one that is not there leaves it", "[STUDY-100]") {
    const TemporaryDirectory directory;
    const identification::ConfigFiles files{.rig = "landing_gear.toml", .controller = "controller.toml"};
    identification::Identified with = found(20.7e6), without = found(20.7e6);
    without.wheel = {.inertia_kgm2 = about(1.3),
                     .gain_m3 = about(1e-3),
                     .friction = about(0.3),
                     .contact_Pa = {},
                     .piston_friction = {},
                     .friction_class = "heavy",
                     .relative_friction = {about(1.0), about(0.0), about(0.0), about(0.0)},
                     .misfit = 0.9,
                     .lags_s = 0.0,
                     .residuals = {}};
    with.wheel = without.wheel;
    with.wheel->contact_Pa = about(0.8e6);
    with.wheel->piston_friction = about(0.03);
    const std::filesystem::path added(directory / "added"), changed(directory / "changed"), removed(directory / "removed");
    identification::write_config(with, files, "config", added);
    CHECK(rig::load_rig(added, {}).rig.clamping.contact_Pa == Approx(0.8e6));
    CHECK(rig::load_rig(added, {}).rig.clamping.piston_friction == Approx(0.03));
    with.wheel->contact_Pa = about(0.5e6);
    with.wheel->piston_friction.reset();
    identification::write_config(with, files, added, changed);
    CHECK(rig::load_rig(changed, {}).rig.clamping.contact_Pa == Approx(0.5e6));
    CHECK(rig::load_rig(changed, {}).rig.clamping.piston_friction == 0.0);
    identification::write_config(without, files, changed, removed);
    CHECK(rig::load_rig(removed, {}).rig.clamping.contact_Pa == 0.0);
    CHECK_FALSE(rig::load_rig(removed, {}).rig.clamping.any());
    CHECK_THAT(identification::to_table(with), ContainsSubstring("contact pressure") && ContainsSubstring("0.5 MPa"));
    CHECK_THAT(identification::to_table(without), !ContainsSubstring("contact pressure"));
}

TEST_CASE("a hysteresis and a line that the file assumed do not outlive an identification without them", "[STUDY-100]") {
    const TemporaryDirectory directory;
    const std::filesystem::path from = std::filesystem::path(directory / "assumed");
    std::filesystem::copy("config", from, std::filesystem::copy_options::recursive);
    std::stringstream text;
    text << std::ifstream(from / "landing_gear.toml").rdbuf();
    std::string assumed = text.str();
    const std::string key = "\ndelay_ms = ";
    assumed.replace(assumed.find(key), key.size(), "\nhysteresis_mA = 0.8\nline_ms = 5.0" + key);
    std::ofstream(from / "landing_gear.toml") << assumed;
    rig::ManeuverChoice choice;
    choice.surface = "snow";
    REQUIRE(rig::load_rig(from, choice).rig.valve.line_s == Approx(5e-3));

    identification::Identified none = found(20.7e6);
    none.valve.hysteresis_mA = {.value = 2e-5, .deviation = 2e-4, .low = -4e-4, .high = 4.4e-4};
    const identification::ConfigFiles files{.rig = "landing_gear.toml", .controller = "controller.toml"};
    identification::write_config(none, files, from, std::filesystem::path(directory / "none"));
    const rig::ValveParameters valve = rig::load_rig(directory / "none", choice).rig.valve;
    CHECK(valve.hysteresis_mA == 0.0);
    CHECK(valve.line_s == 0.0);

    identification::write_config(found(20.7e6), files, from, std::filesystem::path(directory / "some"));
    CHECK(rig::load_rig(directory / "some", choice).rig.valve.hysteresis_mA == Approx(0.25));
    CHECK(rig::load_rig(directory / "some", choice).rig.valve.line_s == 0.0);
}
