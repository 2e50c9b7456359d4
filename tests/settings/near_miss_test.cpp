#include "firmware/host/settings/near_miss.hpp"

#include <array>

#include "tests/catch.hpp"

namespace {

std::string_view nearest_surface(std::string_view word) {
    static constexpr std::array<std::string_view, 5> kSurfaces{"dry_asphalt", "dry_concrete", "wet_asphalt", "snow", "ice"};
    return settings::nearest(word, kSurfaces);
}

bool is_slip(std::string_view slip, std::string_view meant) {
    const std::array<std::string_view, 1> known{meant};
    return settings::nearest(slip, known) == meant;
}

}  // namespace

TEST_CASE("the nearest word is found, and none when nothing is near", "[CFG-001]") {
    CHECK(nearest_surface("wet_asfalt") == "wet_asphalt");
    CHECK(nearest_surface("dry-concrete") == "dry_concrete");
    CHECK(nearest_surface("SNOW") == "snow");
    CHECK(nearest_surface("icy").empty());
    CHECK(nearest_surface("gravel").empty());
    CHECK(nearest_surface("").empty());
    CHECK(nearest_surface(std::string(100000, 'a')).empty());
}

TEST_CASE("one edit in four letters is a slip, more is not", "[CFG-001]") {
    CHECK(is_slip("pressure_pa", "pressure_Pa"));
    CHECK(is_slip("hwell", "hwel"));
    CHECK(is_slip("inertai", "inertia"));
    CHECK(is_slip("abcd", "abce"));
    CHECK_FALSE(is_slip("abcd", "abef"));
    CHECK_FALSE(is_slip("J_w", "J_f"));
    CHECK_FALSE(is_slip("medium_2", "medium_3"));
    CHECK_FALSE(is_slip("c1", "c2"));
}

TEST_CASE("a unit is told from the rest of a name", "[CFG-001]") {
    CHECK(settings::differs_in_unit("speed_mps", "speed_kt"));
    CHECK(settings::differs_in_unit("speed_mps", "speed"));
    CHECK(settings::differs_in_unit("r_0_m", "r_0_mm"));
    CHECK_FALSE(settings::differs_in_unit("speed_mps", "speed_mps"));
    CHECK_FALSE(settings::differs_in_unit("speed_mps", "speed_limit"));
    CHECK_FALSE(settings::differs_in_unit("speed_mps", "speed_"));
    CHECK_FALSE(settings::differs_in_unit("speed_mps", "speeds_kt"));
    CHECK_FALSE(settings::differs_in_unit("min_count", "min_value"));
    CHECK_FALSE(settings::differs_in_unit("teeth", "teeth_m"));
}

TEST_CASE("a name cannot write to the terminal", "[CFG-021]") {
    CHECK(settings::printable("gr\xC3\xBC\xC3\x9F") == "gr\xC3\xBC\xC3\x9F");
    CHECK(settings::printable("a\x1B[31m\n\x7F") == "a\\x1b[31m\\x0a\\x7f");
    CHECK(settings::printable("\xC2\x9B"
                              "2J") == "\\xc2\\x9b2J");
}
