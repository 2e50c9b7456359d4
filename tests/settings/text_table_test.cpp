// Tables as text: names and values by one format a column, for the screen, as CSV and in Markdown.
#include "firmware/host/settings/text_table.hpp"

#include "tests/catch.hpp"

using settings::TextTable;

TEST_CASE("columns of a table for the screen are as wide as said, names as their values") {
    auto table = TextTable::screen("surface:<9|c1:>8.3f|note", "  ");
    table.add(std::string("ice"), 0.05, "slippery");
    table.add("snow", "-", std::optional<int>());
    table.line("2 surfaces");
    CHECK(table.text() == "  surface        c1note\n  ice         0.050slippery\n  snow            -\n2 surfaces\n");
}

TEST_CASE("a CSV has a value a column, to the last bit where no format is given; what is missing is empty") {
    auto table = TextTable::csv("n|exact|short:.2f|missing:.1f");
    table.add(1);
    table.add(1.0 / 3.0, 2.0 / 3.0, std::optional<double>());
    table.add(2, 0.1, 0.1, std::optional(0.25));
    CHECK(table.text() == "n,exact,short,missing\n1,0.3333333333333333,0.67,\n2,0.1,0.10,0.2\n");
}

TEST_CASE("a table in Markdown has its rule") {
    auto table = TextTable::markdown("law: its name:|J_mu:.2f");
    table.add("slip", 0.96);
    CHECK(table.text() == "| law: its name | J_mu |\n|---|---|\n| slip | 0.96 |\n");
}
