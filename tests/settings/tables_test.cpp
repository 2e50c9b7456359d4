#include "tests/settings/refusal.hpp"

TEST_CASE("named tables come in the order of the file, with their names", "[CFG-001]") {
    const auto doc = parsed(
        "[surfaces.wet]\nc1 = 0.8\n[surfaces.dry]\nc1 = 1.2\n[surfaces.damp]\nc1 = 1.0\n"
        "[surfaces]\nice = { c1 = 0.05 }\nbare = { c1 = 0.1 }\n");
    std::string names;
    for (const auto& surface : doc.root().table("surfaces").tables()) {
        names += surface.name() + " ";
        CHECK(surface.path() == "surfaces." + surface.name());
        CHECK(surface.number("c1") > 0.0);
    }
    CHECK(names == "wet dry damp ice bare ");
    CHECK(doc.root().tables("surfaces", {.min = 5, .max = 5}).size() == 5);
    CHECK_NOTHROW(doc.finish());
}

TEST_CASE("an array of tables comes in order, and its elements are named by their index", "[CFG-001]") {
    const auto doc = parsed("[can]\n[[can.signal]]\nid = 1\n[[can.signal]]\nid = 2\n[[can.signal]]\nid = 'x'\n");
    const auto signals = doc.root().table("can").tables("signal");
    REQUIRE(signals.size() == 3);
    CHECK(signals[0].integer("id") == 1);
    CHECK(signals[1].integer("id") == 2);
    CHECK(signals[1].name() == "signal[1]");
    CHECK(signals[1].path() == "can.signal[1]");
    CHECK(rejection_of([&] { return signals[2].integer("id"); }).what() ==
          std::string("plant.toml:7: can.signal[2].id: expected an integer, got the string 'x'"));
}

TEST_CASE("tables are counted, and nothing else may stand among them", "[CFG-001]") {
    const auto rejected = [](const std::string& text, const settings::Count& count = {}) {
        const auto doc = parsed(text);
        return std::string(rejection_of([&] { return doc.root().tables("s", count); }).what());
    };
    CHECK(rejected("t = 1") == "plant.toml: s: missing");
    CHECK(rejected("s = []") == "plant.toml:1: s: the number of tables, 0 is below 1");
    CHECK(rejected("\n[s]") == "plant.toml:2: s: the number of tables, 0 is below 1");
    CHECK(rejected("s = [{}, {}]", {.max = 1}) == "plant.toml:1: s: the number of tables, 2 is out of range 1 to 1");
    CHECK(rejected("s = [{}, 3]") == "plant.toml:1: s: expected an array of tables only, got the integer 3");
    CHECK(rejected("[s.a]\nx = 1\n[s]\nstray = 2") == "plant.toml:4: s.stray: expected a table, got the integer 2");
}

TEST_CASE("a check of the caller fails at the line of its key", "[CFG-001]") {
    const auto doc = parsed("a = 1\n[wheel]\nmass_kg = 3\n");
    const auto wheel = doc.root().table("wheel");
    CHECK(rejection_of([&] {
              wheel.fail("mass_kg", "is above the load");
              return 0;
          }).what() == std::string("plant.toml:3: wheel.mass_kg: is above the load"));
    CHECK(rejection_of([&] {
              wheel.fail("absent", "contradicts");
              return 0;
          }).what() == std::string("plant.toml:2: wheel.absent: contradicts"));
    CHECK(rejection_of([&] {
              wheel.fail("", "is contradictory");
              return 0;
          }).what() == std::string("plant.toml:2: wheel: is contradictory"));
    CHECK(rejection_of([&] {
              doc.root().fail("", "is contradictory");
              return 0;
          }).what() == std::string("plant.toml: is contradictory"));
}

TEST_CASE("a table outlives the document it came from", "[CFG-021]") {
    const auto table = [] { return parsed("[a.b]\nx = 4\n").root().table("a").table("b"); }();
    CHECK(table.number("x") == 4.0);
    CHECK(table.file() == "plant.toml");
}
