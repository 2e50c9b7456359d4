#include "tests/settings/refusal.hpp"

namespace {

std::string finish(const settings::Document& doc) {
    return rejection_of([&] {
               doc.finish();
               return 0;
           })
        .what();
}

std::string missing(const settings::Document& doc, std::string_view key) {
    return rejection_of([&] { return doc.root().table("wheel").number(key); }).what();
}

}  // namespace

TEST_CASE("a document whose every key was read is accepted", "[CFG-001]") {
    const auto doc = parsed("a = 1\n[t]\nb = [1, 2]\n[[t.u]]\nc = 'x'\n[[t.u]]\nc = 'y'\n");
    CHECK(doc.root().number("a") == 1.0);
    CHECK(doc.root().table("t").numbers("b").size() == 2);
    for (const auto& u : doc.root().table("t").tables("u")) CHECK_FALSE(u.text("c").empty());
    CHECK_NOTHROW(doc.finish());
    CHECK_NOTHROW(parsed("").finish());
}

TEST_CASE("the first key by line that nobody asked for is refused", "[CFG-001]") {
    const auto doc = parsed("z = 1\n[b]\nx = 1\n[a]\nx = 1\n");
    CHECK(doc.root().table("a").number("x") == 1.0);
    CHECK(finish(doc) == "plant.toml:1: z: unknown key");
    CHECK(doc.root().number("z") == 1.0);
    CHECK(finish(doc) == "plant.toml:2: b: unknown table");
    CHECK(doc.root().find_table("b").has_value());
    CHECK(finish(doc) == "plant.toml:3: b.x: unknown key");
    CHECK(doc.root().table("b").has("x"));
    CHECK_NOTHROW(doc.finish());
}

TEST_CASE("an unread key is found in every corner of the document", "[CFG-001]") {
    const auto nested = parsed("[[a]]\nx = 1\n[[a.b]]\ny = 1\n[[a.b]]\ny = 2\nstray = 3\n[[a]]\nx = 2\n");
    for (const auto& a : nested.root().tables("a")) {
        static_cast<void>(a.number("x"));
        for (const auto& b : a.tables("b", {.min = 0})) static_cast<void>(b.number("y"));
    }
    CHECK(finish(nested) == "plant.toml:7: a[0].b[1].stray: unknown key");

    const auto inline_table = parsed("t = { x = 1, stray = 2 }\n");
    static_cast<void>(inline_table.root().table("t").number("x"));
    CHECK(finish(inline_table) == "plant.toml:1: t.stray: unknown key");

    const auto dotted = parsed("t.x = 1\nt.deep.stray = 2\n");
    static_cast<void>(dotted.root().table("t").number("x"));
    CHECK(finish(dotted) == "plant.toml:2: t.deep: unknown table");

    const auto second_only = parsed("[[a]]\nx = 1\n[[a]]\nx = 2\n");
    static_cast<void>(second_only.root().tables("a")[1].number("x"));
    CHECK(finish(second_only) == "plant.toml:2: a[0].x: unknown key");

    const auto nameless = parsed("\n\"\" = 1\n");
    CHECK(rejection_of([&] {
              nameless.finish();
              return 0;
          }).line() == 2);
}

TEST_CASE("an unknown key that resembles a known one is told so", "[CFG-001]") {
    const auto doc = parsed("[wheeel]\n[wheel]\nteeth = 60\ntteeth = 61\nc1 = 1\nc2 = 2\n");
    CHECK(rejection_of([&] { return doc.root().table("weel"); }).what() == std::string("plant.toml:2: weel: missing; is 'wheel' a slip of it?"));
    const auto wheel = doc.root().table("wheel");
    CHECK(wheel.integer("teeth") == 60);
    CHECK(wheel.number("c1") == 1.0);
    CHECK(finish(doc) == "plant.toml:1: wheeel: unknown table; did you mean 'wheel'?");
    CHECK(doc.root().has("wheeel"));
    CHECK(finish(doc) == "plant.toml:4: wheel.tteeth: unknown key; did you mean 'teeth'?");
    CHECK(wheel.has("tteeth"));
    CHECK(finish(doc) == "plant.toml:6: wheel.c2: unknown key");
}

TEST_CASE("a known key that is missing is a likelier meaning than one that is there", "[CFG-001]") {
    const auto doc = parsed("bias = 1\nbiss = 2\n");
    CHECK(doc.root().has("bias"));
    CHECK_FALSE(doc.root().has("bits"));
    CHECK(finish(doc) == "plant.toml:2: biss: unknown key; did you mean 'bits'?");
}

TEST_CASE("a missing key names itself, its table and what may stand in its place", "[CFG-001]") {
    CHECK(missing(parsed("\n[wheel]\nx = 1\n"), "inertia_kgm2") == "plant.toml:2: wheel.inertia_kgm2: missing");
    CHECK(missing(parsed("\n[wheel]\nx = 1\ninertai_kgm2 = 1.3\n"), "inertia_kgm2") ==
          "plant.toml:4: wheel.inertia_kgm2: missing; is 'inertai_kgm2' a slip of it?");
    CHECK(missing(parsed("wheels = {}\n"), "x") == "plant.toml:1: wheel: missing; is 'wheels' a slip of it?");
    CHECK(missing(parsed(""), "x") == "plant.toml: wheel: missing");

    const auto taken = parsed("[wheel]\nmass_kg = 3\n");
    CHECK(taken.root().table("wheel").number("mass_kg") == 3.0);
    CHECK(missing(taken, "masss_kg") == "plant.toml:1: wheel.masss_kg: missing");
}

TEST_CASE("a key in another unit is a refused unit, not a missing and an unknown key", "[CFG-001]") {
    CHECK(missing(parsed("[wheel]\nmass_lb = 6000\n"), "mass_kg") == "plant.toml:2: wheel.mass_lb: unit: expected mass_kg, got mass_lb");
    CHECK(missing(parsed("[wheel]\nmass = 6000\n"), "mass_kg") == "plant.toml:2: wheel.mass: unit: expected mass_kg, got mass");
    CHECK(missing(parsed("[wheel]\nmass_limit = 6000\n"), "mass_kg") == "plant.toml:1: wheel.mass_kg: missing");

    const auto doc = parsed("pressure_psi = 3000\n");
    CHECK(doc.root().find_number("pressure_Pa") == std::nullopt);
    CHECK(finish(doc) == "plant.toml:1: pressure_psi: unit: expected pressure_Pa, got pressure_psi");
}
