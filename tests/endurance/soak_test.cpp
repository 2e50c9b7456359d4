/// Does the soak see what creeps, and nothing where nothing does?
#include "plant_sim/endurance/soak.hpp"

#include "firmware/host/settings/json.hpp"
#include "tests/catch.hpp"
#include "tests/endurance/truth.hpp"

using endurance::SoakResult;
using endurance::violations;
using endurance_test::setup;

namespace {

constexpr endurance::SoakOptions kShort{.seconds = 900.0, .seed = 3};

std::size_t constant() {
    return 1000;
}

}  // namespace

TEST_CASE("landings back to back: nothing creeps, same seed, same result", "[STUDY-590]") {
    const endurance::EnduranceSetup s = setup("heavy");
    double share = 0.0;
    const SoakResult r = endurance::soak(s, kShort, constant, [&share](double now) {
        CHECK(now >= share);
        share = now;
    });
    CHECK(share == 1.0);
    CHECK(violations(r).empty());
    CHECK(r.seconds >= kShort.seconds);
    std::int64_t landings = 0;
    for (const endurance::SoakSpan& span : r.spans) landings += span.landings;
    CHECK(landings == r.landings);
    CHECK(r.landings > 20);
    CHECK(endurance::to_json(r, s, 3) == endurance::to_json(endurance::soak(s, kShort, constant), s, 3));
    const auto json = settings::parse_json(endurance::to_json(r, s, 3));
    CHECK(json["landings"] == r.landings);
    CHECK(json["spans"].size() == SoakResult::kSpans);
}

TEST_CASE("heap that grows by a byte an hour is a complaint, heap that was warmed up is none", "[STUDY-590]") {
    const endurance::EnduranceSetup s = setup("heavy");
    std::size_t heap = 0;
    SECTION("it grows") {
        const auto grown = violations(endurance::soak(s, kShort, [&heap] { return ++heap; }));
        REQUIRE(grown.size() == 10);
        CHECK(grown.front().find("span 3") != std::string::npos);
    }
    SECTION("it grows once at first") {
        CHECK(violations(endurance::soak(s, kShort, [&heap] { return heap = 500; })).empty());
    }
}

TEST_CASE("a landing that goes wrong ends the soak and is named", "[STUDY-590]") {
    endurance::EnduranceSetup s = setup("heavy");
    s.controller.monitor.off_command_Pa = 1e4F;  // every landing has this fault
    const SoakResult r = endurance::soak(s, kShort, constant);
    CHECK(r.landings == 1);
    REQUIRE(violations(r).size() == 1);
    CHECK(violations(r).front().find("landing 1") != std::string::npos);
}

TEST_CASE("stops that get longer are a complaint, stops that scatter are none", "[STUDY-590]") {
    SoakResult r;
    for (std::size_t i = 0; i < SoakResult::kSpans; ++i)
        r.spans[i] = {.landings = 100, .length_m_mean = 200.0, .length_m_deviation = 2.0, .max_heap_bytes = 1};
    CHECK(violations(r).empty());
    // Standard error of a third: 2 / sqrt(400) = 0.1 m; of the difference 0.141 m.
    const double longer_m = GENERATE(0.55, 0.58);
    for (std::size_t i = 8; i < SoakResult::kSpans; ++i) r.spans[i].length_m_mean += longer_m;
    CHECK(violations(r).empty() == (longer_m < 0.5656));
}
