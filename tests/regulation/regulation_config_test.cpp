#include "rig_bridge/wear/regulation_config.hpp"

#include <fstream>
#include <string>

#include "tests/catch.hpp"

using wear::RegulationConfig;

namespace {

constexpr const char* kShipped = "config/regulation.toml";

std::string contents(const std::string& path) {
    std::ifstream in(path);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// The shipped file with one text replaced, in a directory with the shipped floor table.
class Changed {
  public:
    Changed(const std::string& what, const std::string& by) {
        const auto here = std::filesystem::temp_directory_path();
        file_ = here / "regulation_changed.toml";
        std::string text = contents(kShipped);
        REQUIRE(text.find(what) != std::string::npos);
        text.replace(text.find(what), what.size(), by);
        std::ofstream(file_) << text;
        std::filesystem::copy_file("config/regulation_floor.toml", here / "regulation_floor.toml", std::filesystem::copy_options::overwrite_existing);
    }
    [[nodiscard]] const std::filesystem::path& file() const { return file_; }

  private:
    std::filesystem::path file_;
};

void rejects(const std::string& what, const std::string& by, const std::string& message) {
    const Changed changed(what, by);
    CAPTURE(by);
    CHECK_THROWS_WITH(wear::load_regulation_config(changed.file()), ContainsSubstring("regulation_changed.toml:") && ContainsSubstring(message));
}

}  // namespace

TEST_CASE("the shipped file: a plan that is feasible within the range of its floor", "[STUDY-167]") {
    const RegulationConfig config = wear::load_regulation_config(kShipped);
    CHECK(config.surfaces.size() == 8);
    const wear::Range range = config.range();
    CHECK(range.lowest < 0.24);
    CHECK(range.highest > 0.30);
    const wear::WearPlan plan = wear::plan_of(config, 3.90e9, 5.12e6, 1.87e6);
    CHECK(plan.landings == 256);
    const double share = plan.tyre_budget_J() / (plan.tyre_budget_J() + plan.brake_budget_J());
    CHECK(share > range.lowest);
    CHECK(share < range.highest * 0.93);
    CHECK((plan.tyre_budget_J() + plan.brake_budget_J()) / (256 * 5.12e6) == Approx(1.0).margin(0.01));
}

TEST_CASE("a planned ratio without a planned landing is met when the landings bring it", "[STUDY-167]") {
    const Changed changed("landings = 256\n", "");
    const RegulationConfig config = wear::load_regulation_config(changed.file());
    const wear::WearPlan plan = wear::plan_of(config, 3.90e9, 6.6e6, 1.9e6);
    CHECK(plan.landings == 200);  // (0.95 + 0.37) GJ
}

TEST_CASE("surfaces to reckon with are all, unless the file names them; each alone is known", "[STUDY-167]") {
    const Changed changed("surfaces = \"all\"", "surfaces = \"dry_cobblestone, ice\"");
    const RegulationConfig two = wear::load_regulation_config(changed.file());
    CHECK(two.surfaces == std::vector<std::string>{"dry_cobblestone", "ice"});
    const RegulationConfig all = wear::load_regulation_config(kShipped);
    CHECK(two.range().lowest == all.range().lowest);  // cobblestone bounds it from below
    CHECK(two.range().highest == 0.5);
    CHECK(two.range("dry_concrete").highest == all.range().highest);
    CHECK(all.range_on("ice") == wear::Range{0.06, 0.5});
    const Changed left_out("surfaces = \"all\"\n", "");
    CHECK(wear::load_regulation_config(left_out.file()).surfaces == all.surfaces);
    rejects("surfaces = \"all\"", "surfaces = \"ice, grass\"", "floor.surfaces: 'grass' is no surface");
    // A default below the floor on a surface that is not named would be found out on the day of landing there.
    const Changed few("surfaces = \"all\"", "surfaces = \"snow\"");
    std::string text = contents(few.file());
    text.replace(text.find("default = 0.24"), 14, "default = 0.10");
    std::ofstream(few.file()) << text;
    CHECK_THROWS_WITH(wear::load_regulation_config(few.file()), ContainsSubstring("on dry_cobblestone J_mu"));
}

TEST_CASE("a forecast is asked for by its table, and left out without it", "[STUDY-167]") {
    CHECK(wear::load_regulation_config(kShipped).forecast_widest == 0.15);
    std::string text = contents(kShipped);
    text.resize(text.find("[forecast]"));
    const Changed changed("tolerance", "tolerance");
    std::ofstream(changed.file()) << text;
    CHECK(wear::load_regulation_config(changed.file()).forecast_widest == 0.0);
    rejects("widest = 0.15", "widest = 0.0", "forecast.widest");
}

TEST_CASE("deviations and prices are an owner's: all there, none below nothing", "[STUDY-169]") {
    const RegulationConfig config = wear::load_regulation_config(kShipped);
    CHECK(config.deviations.brake == 0.12);
    CHECK(config.prices.brake > config.prices.visit);
    rejects("visit = 800.0", "visit = -1.0", "prices.visit");
    rejects("metre = 0.02", "foot = 0.02", "metre");
    rejects("inspection = 0.02", "inspection = 2.0", "deviations.inspection");
}

TEST_CASE("what cannot be is refused with file, line and key", "[STUDY-167]") {
    rejects("tyre_life_J = 0.37e9", "tyre_life_MJ = 400", "tyre_life_J");
    rejects("tyre_taken_J = 0.0", "tyre_taken_J = 1e9", "plan.tyre_taken_J: is not below tyre_life_J");
    rejects("landings = 256", "landings = 0", "plan.landings");
    rejects("default = 0.24", "default = 0.9", "reference.default");
    rejects("step = 0.02", "step = 0.02\nstride = 2", "reference.stride");
    rejects("j_mu = 0.85", "j_mu = 0.99", "below the floor 0.99");
    const RegulationConfig config = wear::load_regulation_config(kShipped);
    CHECK_THROWS_WITH(wear::plan_of(config, 1e9, 5e6, 1e6), ContainsSubstring("plan.brake_taken_J"));
    CHECK_THROWS_WITH(config.range("grass"), ContainsSubstring("grass") && ContainsSubstring("snow"));
    const Changed missing("regulation_floor.toml\"", "no_such_floor.toml\"");
    CHECK_THROWS_WITH(wear::load_regulation_config(missing.file()), ContainsSubstring("no_such_floor.toml"));
}

TEST_CASE("a characterisation comes back as it was written", "[STUDY-167]") {
    const wear::SurfaceTable table{.reference = {0.1, 0.24, 0.5},
                                   .rows = {{"snow", {0.9912, 0.9443, 0.8}, {0.1061, 0.2339, 0.48}, {2100.5, 2000.0, 2300.1}},
                                            {"ice", {0.99, 0.98, 0.97}, {0.1, 0.2, 0.4}, {5000.0, 5000.1, 5000.2}}}};
    const auto file = std::filesystem::temp_directory_path() / "regulation_characterised.toml";
    std::ofstream(file) << wear::to_toml(table, "rig-lab regulate");
    const wear::SurfaceTable read = wear::load_surface_table(file);
    CHECK(read.reference == table.reference);
    REQUIRE(read.rows.size() == 2);
    for (std::size_t s = 0; s < 2; ++s) {
        CHECK(read.rows[s].surface == table.rows[s].surface);
        CHECK(read.rows[s].j_mu == table.rows[s].j_mu);
        CHECK(read.rows[s].tyre_share == table.rows[s].tyre_share);
        CHECK(read.rows[s].distance_m == table.rows[s].distance_m);
    }
}
