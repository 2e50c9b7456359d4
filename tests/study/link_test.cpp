/// The in-process short cut without bytes gives the commands of the frames, and a run is a function of its seed.
#include "tests/catch.hpp"
#include "tests/study/scenarios.hpp"

#include <cstring>

namespace {

/// Valve currents and states of a run, as bits.
std::vector<std::uint64_t> decisions(const plant_sim::StopOptions& options, study::Link link) {
    std::vector<std::uint64_t> bits;
    (void)scenarios::run(options, link, [&bits](const study::RigSession& session, const antiskid::can::ControllerView&, double current_mA) {
        std::uint64_t word = 0;
        std::memcpy(&word, &current_mA, sizeof word);
        bits.push_back(word);
        const double v = session.rig().wheel().v_mps;
        std::memcpy(&word, &v, sizeof word);
        bits.push_back(word);
    });
    return bits;
}

std::vector<std::string> commands(const plant_sim::StopOptions& options) {
    const auto layout = plant_sim::load_scenario(options).layout;
    std::vector<std::string> frames;
    (void)scenarios::run(options, study::Link::frames, {}, [&](const antiskid::can::Frame& frame) {
        if (frame.id != layout[antiskid::can::Role::valve].id) return;
        frames.emplace_back(frame.data.begin(), frame.data.begin() + frame.length);
    });
    return frames;
}

}  // namespace

TEST_CASE("without bytes: the same commands, bit for bit, both layouts, every law that they have", "[STUDY-010]") {
    for (const std::string layout : {"antiskid", "foreign"}) {
        for (const std::string law : {"slip", "threshold", "deceleration", "pressure_bias", "peak_slip"}) {
            for (const scenarios::Name& name :
                 {scenarios::Name{"dry_asphalt", "heavy"}, {"dry_cobblestone", "light"}, {"wet_cobblestone", "medium_a"}}) {
                INFO(layout << ", " << law << ", " << name.surface);
                auto options = scenarios::options(name, law);
                options.deceleration_mps2 = 3.0;
                options.dbc = scenarios::kConfig / (layout + ".dbc");
                options.binding = scenarios::kConfig / (layout + "_binding.toml");
                if (layout == "foreign" && (law == "pressure_bias" || law == "peak_slip")) continue;  // the field has 2 bits
                const auto rounded = decisions(options, study::Link::rounded);
                CHECK(rounded.size() > 1000);
                CHECK(rounded == decisions(options, study::Link::frames));
            }
        }
    }
}

TEST_CASE("a law that the bus has no code for is refused by name", "[CTL-330]") {
    auto options = scenarios::options({"dry_asphalt", "heavy"}, "pressure_bias");
    options.dbc = scenarios::kConfig / "foreign.dbc";
    options.binding = scenarios::kConfig / "foreign_binding.toml";
    CHECK_THROWS_WITH(plant_sim::load_scenario(options), ContainsSubstring("pressure_bias") && ContainsSubstring("foreign.dbc"));
}

TEST_CASE("same seed, same bytes; another seed, other bytes", "[STUDY-010]") {
    auto options = scenarios::options({"wet_asphalt", "light"});
    const auto once = commands(options);
    CHECK(once == commands(options));
    options.seed = 2;
    CHECK(once != commands(options));
}

TEST_CASE("a foreign layout runs the same landing: rpm, bar, Motorola, 5 ms pressure, no CRC on sensors", "[STUDY-010]") {
    for (const char* surface : {"dry_asphalt", "wet_asphalt", "snow", "ice"}) {
        INFO(surface);
        auto options = scenarios::options({surface, "heavy"});
        options.dbc = scenarios::kConfig / "foreign.dbc";
        options.binding = scenarios::kConfig / "foreign_binding.toml";
        const auto run = scenarios::run(options, study::Link::frames);
        CHECK(run.faults.empty());
        CHECK(run.figures.standstill);
        CHECK(run.figures.tracked_share >= 0.95);
        CHECK(run.figures.longest_lock_s <= 0.050);
    }
}
