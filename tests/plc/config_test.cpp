/// config/rig_machinery.toml: read, and every mistake in it refused with its place.
#include <filesystem>
#include <sstream>

#include "plant_sim/plc/load_served_rig.hpp"
#include "tests/settings/refusal.hpp"

namespace {

const std::filesystem::path kFile = "config/rig_machinery.toml";

/// The Error for a file that is the shipped one but for line `number`, which is `line`.
settings::Error with_line(std::size_t number, const std::string& line) {
    const TemporaryDirectory directory;
    std::istringstream shipped(content_of(kFile));
    std::string text;
    std::string each;
    for (std::size_t i = 1; std::getline(shipped, each); ++i) {
        text += i == number ? line : each;
        text += '\n';
    }
    put(directory / "rig_machinery.toml", text);
    return rejection_of([&directory] { return plc::load_served_rig(directory.path(), plc::Bench::landing); });
}

}  // namespace

TEST_CASE("the shipped machinery is read, benches apart", "[RIG-090]") {
    const auto landing = plc::load_served_rig("config", plc::Bench::landing);
    const auto endurance = plc::load_served_rig("config", plc::Bench::endurance);
    CHECK(landing.machinery.drive.torque_Nm == 8000.0);
    CHECK(endurance.machinery.drive.torque_Nm == 1200.0);
    CHECK(plc::machinery_file("config") == kFile);
}

TEST_CASE("every number of the machinery that is missing, misspelt, no number or out of range is refused", "[RIG-090]") {
    std::istringstream shipped(content_of(kFile));
    std::string line;
    int keys = 0;
    for (std::size_t number = 1; std::getline(shipped, line); ++number) {
        const std::size_t equals = line.find('=');
        if (line.empty() || line[0] == '#' || line[0] == '[' || equals == std::string::npos) continue;
        const std::string key = line.substr(0, line.find(' '));
        CAPTURE(number, key);
        ++keys;
        CHECK_THAT(std::string(with_line(number, "").what()), ContainsSubstring(key));
        std::string place = "rig_machinery.toml:";
        place.append(std::to_string(number)).append(":");
        std::string misspelt = "x";
        misspelt.append(line);
        CHECK_THAT(std::string(with_line(number, misspelt).what()), ContainsSubstring(place));
        for (const char* const wrong : {" = nan", " = \"much\"", " = 1e300", " = -1e300"}) {
            const std::string message = with_line(number, key + wrong).what();
            CHECK_THAT(message, ContainsSubstring(place));
            CHECK_THAT(message, ContainsSubstring(key));
        }
    }
    CHECK(keys > 50);
}
