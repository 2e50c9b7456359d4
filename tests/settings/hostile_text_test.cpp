#include <cstdint>
#include <random>

#include "tests/settings/refusal.hpp"

namespace {

std::uint32_t rejected_line(const std::string& text) {
    return rejection_of([&] { return parsed(text); }).line();
}

std::string repeated(std::size_t count, std::string_view part) {
    std::string text;
    for (std::size_t i = 0; i < count; ++i) text += part;
    return text;
}

}  // namespace

TEST_CASE("a syntax error or a duplicate key is refused with its line", "[CFG-001]") {
    CHECK(rejected_line("a = 1\nb = \n") == 2);
    CHECK(rejected_line("a = 1\na = 2\n") == 2);
    CHECK(rejected_line("[t]\na = 1\n[t]\n") == 3);
    CHECK(rejected_line("t.a = 1\n[t]\nb = 2\n[t.a]\n") >= 2);
    CHECK(rejected_line("a = 1\n\n[t\n") == 3);
    CHECK(rejected_line("a = 'open\n") == 1);
    CHECK(rejected_line("x\n") == 1);
    CHECK(rejected_line("a = 1 b = 2\n") == 1);
    CHECK(rejected_line("\n\na = 1,5\n") == 3);
}

TEST_CASE("byte order mark, line ends and unicode are taken as TOML says", "[CFG-021]") {
    const auto marked = parsed(
        "\xEF\xBB\xBF"
        "a = 1\r\n\r\nb = 'x'\r\n[t]\r\nc = true\r\n");
    CHECK(marked.root().number("a") == 1.0);
    CHECK(marked.root().text("b") == "x");
    CHECK(rejection_of([&] { return marked.root().table("t").number("c"); }).line() == 5);

    const auto unicode = parsed("\"m\xC3\xBC_b\" = 0.3\n\"a.b c\" = 1\n\"\\u001b[2J\" = 1\n");
    CHECK(unicode.root().number("m\xC3\xBC_b") == 0.3);
    CHECK(rejection_of([&] { return unicode.root().text("a.b c"); }).key() == "\"a.b c\"");
    CHECK(rejection_of([&] {
              unicode.finish();
              return 0;
          }).key() == "\"\\x1b[2J\"");

    CHECK(parsed("# only a comment").root().tables({.min = 0}).empty());
    CHECK(parsed("\n\n").root().tables({.min = 0}).empty());
    CHECK(rejected_line(std::string("\xFF\xFE"
                                    "a\0=\0",
                                    6)) == 1);
    CHECK(rejected_line("a = 1\nb = '\xC3\x28'\n") == 2);
    CHECK(rejected_line(std::string("a = 1\nb = '\0'\n", 14)) == 2);
    CHECK(rejected_line("a = 1\n\xEF\xBB\xBF"
                        "b = 2\n") == 2);
}

TEST_CASE("depth is bounded before the stack is", "[CFG-021]") {
    const auto rejected = [](const std::string& before, std::size_t count, const std::string& part, const std::string& after) {
        return rejected_line(std::string("\n").append(before).append(repeated(count, part)).append(after));
    };
    CHECK(rejected("a = ", 2000, "[", repeated(2000, "]")) == 2);
    CHECK(rejected("a = ", 4000, "[", "") == 2);
    CHECK(rejected("a = ", 1000, "{a=", "") == 2);
    CHECK(rejected("", 4000000, "a.", "a = 1\n") == 2);
    CHECK(rejected("[", 10000, "a.", "a]\n") == 2);

    constexpr int kDepth = 2000;
    const auto text = std::string("[").append(repeated(kDepth, "a.")).append("a]\n");
    const auto deep = parsed(text + repeated(kDepth, "b.").append("b = 1\n"));
    CHECK(rejection_of([&] {
              deep.finish();
              return 0;
          }).message() == "unknown table");
    auto table = deep.root();
    for (int level = 0; level <= kDepth; ++level) table = table.table("a");
    for (int level = 0; level < kDepth; ++level) table = table.table("b");
    CHECK(table.number("b") == 1.0);
    CHECK_NOTHROW(deep.finish());
}

TEST_CASE("whatever the bytes are, the reader answers with a document or an Error", "[CFG-021]") {
    const std::string valid =
        "mass_kg = 4450\n[wheel]\nJ_kgm2 = 1.3e0\nname = \"m\\u00fc\"\np_Pa = [0, 1.5e6, 2_000]\n"
        "[[signal]]\nid = 0x1F\non = true\nt = 1979-05-27T07:32:00Z\n[surfaces.dry]\nc = { a = 1, b = 'x' "
        "}\n";
    const auto read_all = [](const settings::Document& doc) {
        const auto root = doc.root();
        static_cast<void>(root.find_number("mass_kg"));
        if (const auto wheel = root.find_table("wheel")) {
            static_cast<void>(wheel->find_number("J_kgm2", {.min = 0.0}));
            static_cast<void>(wheel->find_text("name"));
            static_cast<void>(wheel->find_numbers("p_Pa", {.strictly_increasing = true}));
        }
        for (const auto& signal : root.tables("signal", {.min = 0})) static_cast<void>(signal.find_integer<std::uint8_t>("id"));
        for (const auto& surface : root.tables("surfaces", {.min = 0})) static_cast<void>(surface.find_table("c"));
        doc.finish();
    };
    std::mt19937 random(20261121);
    int rejected = 0;
    constexpr int kTrials = 20000;
    for (int trial = 0; trial < kTrials; ++trial) {
        std::string text = valid;
        const auto edits = 1 + random() % 4;
        for (std::uint32_t edit = 0; edit < edits; ++edit) {
            const auto place = random() % text.size();
            switch (random() % 3) {
                case 0:
                    text[place] = static_cast<char>(random() % 256);
                    break;
                case 1:
                    text.erase(place, 1 + random() % 8);
                    break;
                default:
                    text.insert(place, text.substr(random() % text.size(), random() % 16));
            }
        }
        try {
            read_all(parsed(text));
        } catch (const settings::Error& error) {
            ++rejected;
            REQUIRE_THAT(error.what(), ContainsSubstring("plant.toml"));
            REQUIRE_FALSE(error.message().empty());
        }
    }
    CHECK(rejected > kTrials / 2);
}
