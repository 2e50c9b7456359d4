#include "plant_sim/study/regulation/fleet_config.hpp"

#include <algorithm>
#include <fstream>
#include <string>

#include "tests/catch.hpp"

namespace {

/// The shipped file with one text replaced is refused with this message, at that line.
void fleet_refused(const std::string& what, const std::string& by, const std::string& message) {
    std::ifstream in("config/fleet.toml");
    std::string text{std::istreambuf_iterator<char>(in), {}};
    const auto at = text.find(what);
    REQUIRE(at != std::string::npos);
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    text.replace(at, what.size(), by);
    const auto file = std::filesystem::temp_directory_path() / "fleet_changed.toml";
    std::ofstream(file) << text;
    CAPTURE(by);
    CHECK_THROWS_WITH(regulation::load_fleet_config(file),
                      ContainsSubstring("fleet_changed.toml:" + std::to_string(line) + ":") && ContainsSubstring(message));
}

}  // namespace

TEST_CASE("the shipped fleet is read, and judged by other laws than it is tuned on", "[STUDY-171]") {
    const regulation::FleetConfig config = regulation::load_fleet_config("config/fleet.toml");
    CHECK(config.aircraft == 12);
    CHECK(config.rules.shop.bays == 1);
    CHECK(config.rules.shop.visit_days == 2);
    CHECK(config.rules.landings_a_day == 4);
    CHECK(config.tuning.laws.size() == 3);
    CHECK(config.held_out.laws.front() == wear::arena::Law::ostermeyer);
}

TEST_CASE("a mistake in the fleet's configuration is refused with file, line, key and what would be right", "[STUDY-171]") {
    fleet_refused("bays = 1 ", "bays = 0 ", "shop.bays: 0 is out of range 1 to 1000");
    fleet_refused("ground_day = 2000.0", "ground_day = -1.0", "fleet.ground_day: -1 is out of range 0 to 1e+09");
    fleet_refused("visit_days = 2 ", "visit_days = 2.5 ", "shop.visit_days");
    fleet_refused("laws = \"archard, ", "laws = \"archart, ", "'archart' is no law of wear: expected some of archard, ostermeyer");
    fleet_refused("laws = \"ostermeyer, oxidation", "laws = \"ostermeyer, archard", "held_out.laws: has a law of [tuning]");
}
