/// Every key of the shipped plant and controller files, damaged in turn: each damage is refused with the file and the key.
#include <algorithm>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "firmware/host/controller_config.hpp"
#include "rig_bridge/rig/load_rig.hpp"
#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"

namespace fs = std::filesystem;

namespace {

/// One `key = value` of a TOML file as we write them: one to a line.
struct Entry {
    std::size_t line;  // from 0
    std::string table, key, value, comment;
};

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        lines.push_back(text.substr(at, end - at));
        at = end + 1;
    }
    return lines;
}

std::string trimmed(const std::string& text) {
    const auto first = text.find_first_not_of(' ');
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::vector<Entry> entries_of(const std::vector<std::string>& lines) {
    std::vector<Entry> entries;
    std::string table;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const std::string content = lines[i].substr(0, lines[i].find('#'));
        if (content.starts_with("[")) table = content.substr(1, content.find(']') - 1);
        const auto equals = content.find('=');
        if (equals == std::string::npos) continue;
        entries.push_back({i, table, trimmed(content.substr(0, equals)), trimmed(content.substr(equals + 1)), lines[i].substr(content.size())});
    }
    return entries;
}

std::string joined(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    return text;
}

bool is_text(const Entry& e) {
    return e.value.starts_with("\"");
}
bool is_array(const Entry& e) {
    return e.value.starts_with("[");
}

struct Damage {
    const char* what;
    /// The new line; empty: the entry does not have this damage.
    std::function<std::string(const Entry&)> line;
    /// The damaged value stands on the entry's own line, and the message must say that line.
    bool same_line;
};

const std::vector<Damage>& damages() {
    const auto with_value = [](const std::string& value) { return [value](const Entry& e) { return e.key + " = " + value; }; };
    static const std::vector<Damage> kDamages{
        {"missing", [](const Entry&) { return std::string("# gone"); }, false},
        {"misspelt", [](const Entry& e) { return e.key + "q = " + e.value; }, false},
        {"a table", with_value("{}"), true},
        {"a boolean", with_value("true"), true},
        {"a date", with_value("2026-01-01"), true},
        {"text for a number", [](const Entry& e) { return is_text(e) ? "" : e.key + " = \"1.0\""; }, true},
        {"a number for text", [](const Entry& e) { return is_text(e) ? e.key + " = 1.0" : ""; }, true},
        {"another word", [](const Entry& e) { return is_text(e) ? e.key + " = \"nonsense\"" : ""; }, true},
        {"no word", [](const Entry& e) { return is_text(e) ? e.key + " = \"\"" : ""; }, true},
        {"far above", [](const Entry& e) { return is_text(e) || is_array(e) ? "" : e.key + " = 1e30"; }, true},
        {"far below", [](const Entry& e) { return is_text(e) || is_array(e) ? "" : e.key + " = -1e30"; }, true},
        {"no number", [](const Entry& e) { return is_text(e) || is_array(e) ? "" : e.key + " = nan"; }, true},
        {"infinite", [](const Entry& e) { return is_text(e) || is_array(e) ? "" : e.key + " = inf"; }, true},
        {"an empty array", [](const Entry& e) { return is_array(e) ? e.key + " = []" : ""; }, true},
        {"one element less", [](const Entry& e) { return is_array(e) ? e.key + " = " + e.value.substr(0, e.value.rfind(',')) + "]" : ""; }, false},
        {"an element far above", [](const Entry& e) { return is_array(e) ? e.key + " = [1e30" + e.value.substr(e.value.find(',')) : ""; }, true},
        {"an element of text", [](const Entry& e) { return is_array(e) ? e.key + " = [\"x\"" + e.value.substr(e.value.find(',')) : ""; }, true},
        {"an array for a number", [](const Entry& e) { return is_array(e) ? "" : e.key + " = [" + e.value + "]"; }, true},
    };
    return kDamages;
}

class ConfigCopy {
  public:
    ConfigCopy() {
        for (const auto& file : fs::directory_iterator("config")) {
            if (file.path().extension() == ".toml") fs::copy(file.path(), path() / file.path().filename());
        }
        fs::copy("config/wear", path() / "wear");
    }
    [[nodiscard]] const fs::path& path() const { return directory_.path(); }

    /// Replaces one text, which must be there.
    void replace(const std::string& file, const std::string& from, const std::string& to) const {
        std::string text = content_of(path() / file);
        const auto at = text.find(from);
        REQUIRE(at != std::string::npos);
        put(path() / file, text.replace(at, from.size(), to));
    }

  private:
    TemporaryDirectory directory_;
};

/// Damages every entry of `file` in every way; returns how many damages there were.
int damage_all(const std::string& file, const std::function<void(const fs::path& directory)>& load) {
    const ConfigCopy config;
    const fs::path path = config.path() / file;
    const auto lines = lines_of(content_of(path));
    const auto entries = entries_of(lines);
    int count = 0;
    REQUIRE_NOTHROW(load(config.path()));
    for (const Entry& entry : entries) {
        for (const Damage& damage : damages()) {
            const std::string line = damage.line(entry);
            if (line.empty()) continue;
            auto damaged = lines;
            damaged[entry.line] = line;
            put(path, joined(damaged));
            CAPTURE(file, entry.table, entry.key, damage.what, line);
            ++count;
            try {
                load(config.path());
                FAIL_CHECK("nothing was refused");
            } catch (const settings::Error& error) {
                INFO(error.what());
                CHECK(error.file() == path.string());
                CHECK(std::string(error.what()).find(entry.key) != std::string::npos);
                if (damage.same_line) CHECK(error.line() == entry.line + 1);
            }
        }
    }
    return count;
}

}  // namespace

TEST_CASE("loader: every key of the plant's files, damaged in every way, is refused by name", "[RIG-090]") {
    for (const std::string file : {"surfaces.toml", "maneuvers.toml", "landing_gear.toml", "flywheel_rig.toml"}) {
        // The rig is read whole, whatever the maneuver needs.
        for (const std::string maneuver : {"heavy", rig::kEndurance}) {
            rig::ManeuverChoice choice;
            choice.maneuver = maneuver;
            CHECK(damage_all(file, [&](const fs::path& directory) { (void)rig::load_rig(directory, choice); }) > 100);
        }
    }
}

TEST_CASE("loader: every key of the controller's files, damaged in every way, is refused by name", "[RIG-090]") {
    for (const std::string file : {"controller.toml", "controller_endurance.toml"}) {
        CHECK(damage_all(file, [&](const fs::path& directory) { (void)antiskid::load_controller_config(directory / file); }) > 100);
    }
}

TEST_CASE("loader: a surface by a magic formula, and mistakes in one", "[RIG-264]") {
    rig::ManeuverChoice choice;
    choice.surface = "snow";
    const auto with = [&](const char* table) {
        const ConfigCopy config;
        config.replace("surfaces.toml", "c1 = 0.1946  # [B]\nc2 = 94.129  # [B]\nc3 = 0.0646  # [B]", table);
        return rig::load_rig(config.path(), choice).rig.surface;
    };
    const rig::Surface snow = with("magic_formula = { B = 30.0, C = 1.5, D = 0.19, E = 0.2 }");
    REQUIRE(snow.magic.has_value());
    CHECK_FALSE(snow.plain());
    CHECK(rig::peak(snow).mu == Approx(0.19).epsilon(1e-14));
    CHECK(rig::friction(snow, 0.02).mu == rig::friction(*snow.magic, 0.02).mu);
    CHECK(rejection_of([&] { (void)with("magic_formula = { B = 30.0, C = 2.0, D = 0.19, E = 0.2 }"); }).key() == "surfaces.snow.magic_formula.C");
    CHECK(rejection_of([&] { (void)with("magic_formula = { B = 30.0, C = 1.5, D = 0.19 }"); }).key() == "surfaces.snow.magic_formula.E");
    CHECK(rejection_of([&] { (void)with("magic_formula = { B = 30.0, C = 1.5, D = 0.19, E = 0.2, H = 0 }"); }).key() ==
          "surfaces.snow.magic_formula.H");
    const auto both = rejection_of([&] { (void)with("c1 = 0.2\nmagic_formula = { B = 30.0, C = 1.5, D = 0.19, E = 0.2 }"); });
    CHECK(both.key() == "surfaces.snow.c1");
    CHECK_THAT(both.what(), ContainsSubstring("magic_formula"));
    const auto misspelt = rejection_of([&] { (void)with("magic_fromula = { B = 30.0, C = 1.5, D = 0.19, E = 0.2 }"); });
    CHECK_THAT(misspelt.what(), ContainsSubstring("expected c1, c2 and c3, or magic_formula"));
}

TEST_CASE("loader: what a brake has between pressure and torque is optional, whole and within its range", "[RIG-265]") {
    const auto with = [](const std::string& lines) {
        const ConfigCopy config;
        config.replace("landing_gear.toml", "[brake.relative_friction]", "[brake.clamping]\n" + lines + "\n[brake.relative_friction]");
        return rig::load_rig(config.path(), {}).rig.clamping;
    };
    CHECK_FALSE(rig::load_rig("config", {}).rig.clamping.any());
    const rig::Clamping all = with("contact_Pa = 1.0e6\npiston_friction = 0.04\nrun_out = 0.05\nwarp = 0.02");
    CHECK(all.contact_Pa == 1e6);
    CHECK(all.piston_friction == 0.04);
    CHECK(all.run_out == 0.05);
    CHECK(all.warp == 0.02);
    CHECK(rejection_of([&] { (void)with("contact_Pa = 1.0e6\npiston_friction = 0.04\nrun_out = 0.05"); }).key() == "brake.clamping.warp");
    CHECK(rejection_of([&] { (void)with("contact_Pa = 1.0e6\npiston_friction = 0.04\nrun_out = 0.7\nwarp = 0.0"); }).key() ==
          "brake.clamping.run_out");
}

TEST_CASE("loader: a missing file is named", "[RIG-090]") {
    for (const std::string file : {"surfaces.toml", "maneuvers.toml", "landing_gear.toml", "flywheel_rig.toml"}) {
        const ConfigCopy config;
        fs::remove(config.path() / file);
        CHECK(rejection_of([&] { return rig::load_rig(config.path(), {}); }).file() == (config.path() / file).string());
    }
}

TEST_CASE("loader: an unknown surface or maneuver names those there are", "[RIG-090]") {
    rig::ManeuverChoice choice;
    choice.surface = "gravel";
    const auto surface = rejection_of([&] { return rig::load_rig("config", choice); });
    CHECK_THAT(surface.what(), ContainsSubstring("config/surfaces.toml"));
    for (const std::string& name : rig::surface_names("config")) CHECK_THAT(surface.what(), ContainsSubstring(name));
    choice.surface = "ice";
    choice.maneuver = "ditching";
    const auto maneuver = rejection_of([&] { return rig::load_rig("config", choice); });
    CHECK_THAT(maneuver.what(), ContainsSubstring("config/maneuvers.toml"));
    for (const std::string& name : rig::maneuver_names("config")) CHECK_THAT(maneuver.what(), ContainsSubstring(name));
    CHECK_THAT(maneuver.what(), ContainsSubstring(rig::kEndurance));
}

TEST_CASE("loader: what cannot be simulated is refused", "[RIG-090]") {
    SECTION("more lift than weight, from the file or by the speed asked for") {
        const ConfigCopy config;
        config.replace("landing_gear.toml", "lift_area_m2 = 5.9", "lift_area_m2 = 50.0");
        const auto error = rejection_of([&] { return rig::load_rig(config.path(), {}); });
        CHECK(error.key() == "aircraft.lift_area_m2");
        rig::ManeuverChoice fast;
        fast.maneuver = "light";
        fast.speed_mps = 115.0;
        CHECK_THAT(rejection_of([&] { return rig::load_rig("config", fast); }).what(), ContainsSubstring("lift_area_m2"));
    }
    SECTION("a tyre that the load flattens to the rim") {
        const ConfigCopy config;
        config.replace("landing_gear.toml", "stiffness_Npm = 2.7e6", "stiffness_Npm = 1e5");
        CHECK_THAT(rejection_of([&] { return rig::load_rig(config.path(), {}); }).what(), ContainsSubstring("stiffness_Npm"));
        rig::ManeuverChoice heavy;
        heavy.mass_kg = 99000.0;
        CHECK_THAT(rejection_of([&] { return rig::load_rig("config", heavy); }).what(), ContainsSubstring("stiffness_Npm"));
        const ConfigCopy bench;
        bench.replace("flywheel_rig.toml", "stiffness_Npm = 2.7e6", "stiffness_Npm = 5e4");
        CHECK_THAT(rejection_of([&] { return rig::load_rig(bench.path(), {}); }).what(), ContainsSubstring("stiffness_Npm"));
    }
    SECTION("a brake whose friction would turn negative") {
        const ConfigCopy config;
        config.replace("landing_gear.toml", "heavy = [1.22, -1.02, 0.72, 0.20]", "heavy = [1.22, -9.02, 0.72, 0.20]");
        CHECK_THAT(rejection_of([&] { return rig::load_rig(config.path(), {}); }).what(), ContainsSubstring("heavy"));
        rig::ManeuverChoice worn;
        worn.friction = 0.011;
        CHECK_THROWS_AS(rig::load_rig("config", worn), std::invalid_argument);
    }
    SECTION("a map whose pressure falls, or has another number of points") {
        const ConfigCopy config;
        config.replace("landing_gear.toml", "[0.0, 0.7e6, 2.1e6", "[0.0, 2.7e6, 2.1e6");
        CHECK(rejection_of([&] { return rig::load_rig(config.path(), {}); }).key() == "valve.pressure_Pa");
    }
    SECTION("overrides out of range") {
        for (const double wrong : {-1.0, 0.0, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
            CAPTURE(wrong);
            rig::ManeuverChoice mass, speed, friction;
            mass.mass_kg = wrong;
            speed.speed_mps = wrong;
            friction.friction = wrong;
            CHECK_THROWS_AS(rig::load_rig("config", mass), std::invalid_argument);
            CHECK_THROWS_AS(rig::load_rig("config", speed), std::invalid_argument);
            CHECK_THROWS_AS(rig::load_rig("config", friction), std::invalid_argument);
        }
    }
    SECTION("no surface, no maneuver") {
        const ConfigCopy config;
        put(config.path() / "surfaces.toml", "[surfaces]\n");
        CHECK_THROWS_AS(rig::load_rig(config.path(), {}), settings::Error);
        const ConfigCopy other;
        put(other.path() / "maneuvers.toml", "[maneuvers]\n[reference]\nmaneuver = \"heavy\"\nsurface = \"ice\"\nslip_reference = 0.2\n");
        CHECK_THROWS_AS(rig::load_rig(other.path(), {}), settings::Error);
    }
    SECTION("an unknown table or key anywhere") {
        for (const std::string file : {"surfaces.toml", "maneuvers.toml", "landing_gear.toml", "flywheel_rig.toml"}) {
            const ConfigCopy config;
            put(config.path() / file, content_of(config.path() / file) + "\n[extra]\nthing = 1\n");
            CHECK_THAT(rejection_of([&] { return rig::load_rig(config.path(), {}); }).what(), ContainsSubstring("extra"));
        }
    }
}

TEST_CASE("loader: what is in the files is what the plant gets", "[RIG-090]") {
    rig::ManeuverChoice choice;
    choice.maneuver = "medium_a";
    choice.surface = "snow";
    const rig::LoadedRig loaded = rig::load_rig("config", choice);
    const rig::RigParameters& rig = loaded.rig;
    CHECK(rig.wheel.mass_kg == 3150.0);
    CHECK(rig.wheel.inertia_kgm2 == 1.3);
    CHECK(rig.wheel.free_radius_m == 0.335);
    CHECK(rig.wheel.stiffness_Npm == 2.7e6);
    CHECK(rig.load.base_N == Approx(3150.0 * 9.80665).epsilon(1e-15));
    CHECK(rig.load.lift_Ns2pm2 == Approx(0.5 * 1.225 * 5.9).epsilon(1e-15));
    CHECK(rig.load.lag_s == 0.0);
    CHECK(rig.brake.gain_m3() == Approx(8.04e-4 * 6 * 6 * 0.12).epsilon(1e-15));
    CHECK(rig.mean_friction == 0.30);
    CHECK(rig.friction_curve[1] == Approx(0.30 * -0.60).epsilon(1e-15));
    CHECK(rig.valve.natural_frequency_radps == Approx(2.0 * 3.14159265358979 * 20.0).epsilon(1e-14));
    CHECK(rig.valve.damping == 0.8);
    CHECK(rig.valve.delay_s == Approx(6e-3).epsilon(1e-15));
    CHECK(rig.wheel_encoder.teeth == 60.0);
    CHECK(rig.wheel_encoder.jitter_s == Approx(1e-6).epsilon(1e-15));
    CHECK(rig.flywheel_radius_m == 0.6);
    CHECK(rig.transducer.range_Pa == 25e6);
    CHECK(rig.surface.c2 == 94.129);
    CHECK(rig.brake_on_mps == 52.0);
    CHECK(loaded.drop_out_mps == 5.0);
    CHECK(loaded.full_pressure_Pa == 2.07e7);
    CHECK(loaded.files.size() == 5);

    choice.mass_kg = 3000.0;
    choice.speed_mps = 40.0;
    choice.friction = 0.2;
    choice.carrier = rig::Carrier::flywheel;
    const rig::RigParameters other = rig::load_rig("config", choice).rig;
    CHECK(other.wheel.mass_kg == 3000.0);
    CHECK(other.load.base_N == Approx(3000.0 * 9.80665).epsilon(1e-15));
    CHECK(other.brake_on_mps == 40.0);
    CHECK(other.mean_friction == 0.2);
    CHECK(other.load.lag_s == Approx(0.1).epsilon(1e-15));
}
