#include <sys/stat.h>

#include <atomic>
#include <fstream>
#include <set>
#include <string>

#include "firmware/host/settings/json.hpp"
#include "plant_sim/study/paper/output_html.hpp"
#include "plant_sim/study/paper/page.hpp"
#include "plant_sim/study/paper/run.hpp"
#include "plant_sim/study/paper/sections.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

namespace {

using can_test::TempDir;

const std::string kHead = "title = \"T\"\n";

std::string section(const std::string& id, const std::string& commands, const std::string& more = "") {
    return "[[section]]\nid = \"" + id + "\"\ntitle = \"S <" + id + ">\"\ncommands = \"\"\"\n" + commands + "\n\"\"\"\n" + more;
}

std::string rejection(const std::string& text) {
    const TempDir dir;
    try {
        (void)paper::load_contents(dir.write("report.toml", text));
    } catch (const std::exception& e) {
        const std::string what = e.what();
        return what.substr(what.find("report.toml"));
    }
    return "accepted";
}

/// sh as every program, by the names that the test uses.
std::filesystem::path program(const std::string& name) {
    return name == "nowhere" ? std::filesystem::path{} : std::filesystem::path("/bin") / name;
}

paper::RunOptions options(const TempDir& dir, unsigned jobs) {
    return {.out = dir.path() / "out", .config = "config", .quick = false, .jobs = jobs, .program = program, .progress = {}};
}

const std::string kDot = R"(<svg width="30" height="20" xmlns="http://www.w3.org/2000/svg"><circle cx="5" cy="5" r="5"/></svg>)";

std::size_t count(const std::string& text, const std::string& what) {
    std::size_t n = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++n;
    return n;
}

}  // namespace

TEST_CASE("a report's sections are read, and mistakes refused with line and key", "[STUDY-185]") {
    const TempDir dir;
    const paper::Contents c =
        paper::load_contents(dir.write("r.toml", kHead +
                                                     section("a", "  one {here}\n\n two ",
                                                             "show = [2]\n[[section.picture]]\nfile = \"p.png\"\ncaption = \"P\"\n"
                                                             "command = 1\n[[section.picture]]\nfile = \"q.png\"\ncaption = \"Q\"\n") +
                                                     section("b", "three",
                                                             "after = \"a\"\n[[section.compare]]\nquantity = \"x\"\nsource = \"Table I\"\npaper = "
                                                             "1\nfile = \"f\"\nat = \"/x\"\n")));
    REQUIRE(c.sections.size() == 2);
    CHECK(c.sections[0].commands == std::vector<std::string>{"one {here}", "two"});
    CHECK(c.sections[0].shown == std::vector<std::size_t>{1});
    CHECK(c.sections[0].pictures[0].command == 0);
    CHECK(c.sections[0].pictures[1].command == 1);
    CHECK(c.sections[1].after == "a");
    CHECK(c.sections[1].comparisons[0].printed == 1.0);
    CHECK_THAT(rejection(kHead), ContainsSubstring("section"));
    CHECK_THAT(rejection(kHead + section("a", "x") + section("a", "x")), ContainsSubstring("there are two sections 'a'"));
    CHECK_THAT(rejection(kHead + section("../a", "x")), ContainsSubstring("report.toml:3: section[0].id: names a directory"));
    CHECK_THAT(rejection(kHead + section("a", "x", "after = \"z\"\n")), ContainsSubstring("'z' is no section above"));
    CHECK_THAT(rejection(kHead + section("a", "  ")), ContainsSubstring("no command"));
    CHECK_THAT(rejection(kHead + section("a", "x", "quick_commands = \"\"\"\nx\ny\n\"\"\"\n")), ContainsSubstring("as many as commands"));
    CHECK_THAT(rejection(kHead + section("a", "x", "show = [2]\n")), ContainsSubstring("show"));
    CHECK_THAT(rejection(kHead + section("a", "x", "pictures = 3\n")), ContainsSubstring("pictures"));
}

TEST_CASE("commands run after what they build on; 1 is an answer, 2 ends a section and those that wait for it", "[STUDY-185]") {
    const std::string text = kHead + section("no", "false\ntouch {here}/went_on") + section("bad", "sh {out}/../two\ntouch {here}/went_on") +
                             section("waits", "touch {here}/ran", "after = \"bad\"\n") + section("first", "sh {out}/../slow {here}/made") +
                             section("second", "cat {out}/first/made", "after = \"first\"\n") + section("gone", "nowhere x");
    for (const unsigned jobs : {1U, 4U}) {
        const TempDir dir;
        dir.write("two", "echo said >&2\nexit 2\n");
        dir.write("slow", "sleep 0.2\necho content > \"$1\"\n");
        const paper::Contents contents = paper::load_contents(dir.write("r.toml", text));
        std::atomic<std::size_t> told = 0;
        paper::RunOptions o = options(dir, jobs);
        o.progress = [&](const paper::SectionResult&, std::size_t done, std::size_t all) {
            CHECK(done == ++told);
            CHECK(all == 6);
        };
        const auto r = paper::run_sections(contents, o);
        REQUIRE(r.size() == 6);
        CHECK(told == 6);
        CHECK(r[0].commands[0].status == 1);
        CHECK(std::filesystem::exists(r[0].directory / "went_on"));
        CHECK_FALSE(r[0].passed());
        CHECK_FALSE(r[0].failed());
        CHECK(r[1].commands[0].status == 2);
        CHECK(r[1].commands[0].errors == "said\n");
        CHECK(r[1].commands[1].status == -1);
        CHECK_FALSE(std::filesystem::exists(r[1].directory / "went_on"));
        CHECK(r[2].failed());
        CHECK_FALSE(std::filesystem::exists(r[2].directory / "ran"));
        CHECK(r[4].passed());
        CHECK(r[4].commands[0].output == "content\n");
        CHECK(r[4].commands[0].line == "cat " + (dir.path() / "out/first/made").string());
        CHECK(r[5].failed());
        CHECK_THAT(r[5].commands[0].errors, ContainsSubstring("nowhere: no such program"));
    }
}

TEST_CASE("the quick form has its own commands, and a configuration of its own reaches them", "[STUDY-185]") {
    const TempDir dir;
    const paper::Contents contents = paper::load_contents(
        dir.write("r.toml", kHead + section("a", "echo slow --config {config}", "quick_commands = \"echo quick --config {config}\"\n")));
    paper::RunOptions o = options(dir, 1);
    CHECK(paper::run_sections(contents, o)[0].commands[0].output == "slow\n");
    o.quick = true;
    o.config = "my rig";
    const auto quick = paper::run_sections(contents, o);
    CHECK(quick[0].commands[0].output == "quick --config my rig\n");
    CHECK(quick[0].commands[0].line == "echo quick --config 'my rig'");
}

TEST_CASE("a section may be a text of one's own, whose drawing is kept beside the page", "[STUDY-185]") {
    const TempDir dir;
    const std::string own = kHead + "[[section]]\nid = \"a\"\ntitle = \"A\"\nhtml = \"<p>own</p><svg>drawn</svg><p>more</p>\"\n";
    const paper::Contents contents = paper::load_contents(dir.write("r.toml", own));
    const auto results = paper::run_sections(contents, options(dir, 1));
    CHECK(results[0].passed());
    CHECK_THAT(paper::to_html(contents, results, {}, {}), ContainsSubstring("<p>own</p><svg>drawn</svg><p>more</p>"));
    std::ifstream kept(results[0].directory / "a.svg");
    CHECK(std::string(std::istreambuf_iterator<char>(kept), {}) == "<svg>drawn</svg>");
    const std::string picture = own + "[[section.picture]]\nfile = \"p.svg\"\ncaption = \"P\"\n";
    CHECK_THROWS_WITH(paper::load_contents(dir.write("p.toml", picture)), ContainsSubstring("no command"));
}

TEST_CASE("figures are found in results by name, index, member and size", "[STUDY-185]") {
    const std::string json = R"({"a": {"b": [1.5, {"c": 2}]}, "rows": [{"r": 0.23, "v": 1}, {"r": 0.24, "v": 2, "n": "x"}]})";
    CHECK(paper::value_at(json, "/a/b/0") == 1.5);
    CHECK(paper::value_at(json, "/a/b/1/c") == 2.0);
    CHECK(paper::value_at(json, "/rows[r=0.24]/v") == 2.0);
    CHECK(paper::value_at(json, "/rows[n=x]/r") == 0.24);
    CHECK(paper::value_at(json, "/rows/#") == 2.0);
    CHECK_THROWS_WITH(paper::value_at(json, "/a/x"), ContainsSubstring("nothing at /a/x (no 'x')"));
    CHECK_THROWS_WITH(paper::value_at(json, "/a/b/2"), ContainsSubstring("nothing at"));
    CHECK_THROWS_WITH(paper::value_at(json, "/rows[r=0.5]/v"), ContainsSubstring("no element with r=0.5"));
    CHECK_THROWS_WITH(paper::value_at(json, "/a"), ContainsSubstring("is no number"));
    CHECK_THROWS(paper::value_at("{", "/a"));
}

TEST_CASE("base64 is that of RFC 4648, and text cannot become markup", "[STUDY-185]") {
    CHECK(paper::base64("").empty());
    CHECK(paper::base64("f") == "Zg==");
    CHECK(paper::base64("fo") == "Zm8=");
    CHECK(paper::base64("foo") == "Zm9v");
    CHECK(paper::base64("foob") == "Zm9vYg==");
    CHECK(paper::base64("fooba") == "Zm9vYmE=");
    CHECK(paper::base64("foobar") == "Zm9vYmFy");
    CHECK(paper::base64(std::string("\xFF\xFE\0\x01", 4)) == "//4AAQ==");
    CHECK(paper::escaped("<a b=\"c\" d='e'>&") == "&lt;a b=&quot;c&quot; d=&#39;e&#39;&gt;&amp;");
    CHECK(paper::escaped("a\xFF z") == "a\xEF\xBF\xBD z");
}

TEST_CASE("tables that a command prints in Markdown are tables in the page, all else is as printed", "[STUDY-185]") {
    CHECK(paper::output_html("").empty());
    CHECK(paper::output_html("a  <b>\n c\n") == "<pre>a  &lt;b&gt;\n c</pre>\n");
    CHECK(paper::output_html("before\n\n| a | b & c |\n|---|---:|\n| 1 |  |\n\nafter") ==
          "<pre>before</pre>\n<table class=\"output\">\n<thead><tr><th>a</th><th>b &amp; c</th></tr>\n"
          "</thead>\n<tbody>\n<tr><td>1</td><td></td></tr>\n</tbody></table>\n<pre>after</pre>\n");
    CHECK(paper::output_html("| x |\n| y |") == "<table class=\"output\">\n<tbody>\n<tr><td>x</td></tr>\n<tr><td>y</td></tr>\n</tbody></table>\n");
}

TEST_CASE("the page holds pictures, differences and every no; it needs nothing else", "[STUDY-185]") {
    const TempDir dir;
    dir.write("dot.svg", kDot);
    dir.write("dot.charts.json", R"({"title":"</script><b>"})");
    dir.write("dot.csv", "x,y\n");
    const std::string compare =
        "[[section.compare]]\nquantity = \"shown\"\nsource = \"Table I\"\nfile = \"{config}/c.toml\"\nat = \"/a/b\"\n"
        "[[section.compare]]\nquantity = \"length\"\nunit = \"m\"\nsource = \"Table III\"\npaper = "
        "464.22\nfile = \"r.json\"\nat = "
        "\"/length\"\ndecimals = 2\n[[section.compare]]\nquantity = \"width\"\nsource = \"Fig. 5\"\npaper = "
        "1\nfile = \"r.json\"\nat = "
        "\"/width\"\n";
    const paper::Contents contents = paper::load_contents(
        dir.write("r.toml", kHead +
                                section("yes",
                                        "cp {out}/../dot.svg {here}/a.svg\ncp {out}/../dot.svg {here}/c.svg\ncp {out}/../dot.csv {here}/c.csv\n"
                                        "cp {out}/../dot.charts.json {here}/a.charts.json\ncp {out}/../r.json {here}/r.json\necho <b>shown</b>",
                                        "show = [6]\ntext = \"first\\n\\nsecond\"\n[[section.picture]]\nfile = "
                                        "\"a.svg\"\ncaption = \"A & "
                                        "B\"\ncommand = 1\n[[section.picture]]\nfile = \"c.svg\"\ncaption = \"C\"\n[[section.picture]]\nfile = "
                                        "\"b.svg\"\ncaption = \"missing\"\n" +
                                            compare) +
                                section("no", "false")));
    dir.write("r.json", R"({"length": 463.11})");
    const auto results = paper::run_sections(contents, options(dir, 2));
    dir.write("c.toml", "[a]\nb = 7.5\n");
    const auto rows = paper::compared(results, dir.path());
    REQUIRE(rows.size() == 3);
    CHECK(rows[0].ours == 7.5);
    CHECK(rows[1].ours == 463.11);
    CHECK_FALSE(rows[2].ours.has_value());
    paper::PageHead head{.version = "1.2.3", .config_hash = "abc", .command = "rig-lab report", .quick = true, .charts_library = dir.path() / "none"};
    const std::string html = paper::to_html(contents, results, rows, head);
    CHECK_THAT(html, ContainsSubstring("src=\"data:image/svg+xml;base64," + paper::base64(kDot) + "\""));
    CHECK_THAT(html, ContainsSubstring("width=\"30\" height=\"20\""));
    CHECK_THAT(html, ContainsSubstring("alt=\"A &amp; B\""));
    CHECK_THAT(html, ContainsSubstring("<p>first</p>\n<p>second</p>"));
    CHECK_THAT(html, ContainsSubstring("The picture b.svg is not there"));
    CHECK_THAT(html, ContainsSubstring(">464.22</td><td class=\"n\">463.11</td><td class=\"n\">-1.11</td><td class=\"n\">-0.24 %</td>"));
    CHECK_THAT(html, ContainsSubstring("width: r.json: nothing at /width"));
    CHECK_THAT(html, ContainsSubstring("The answer of this study is no"));
    CHECK_THAT(html, ContainsSubstring("&lt;b&gt;shown&lt;/b&gt;"));
    CHECK_THAT(html, ContainsSubstring("quick form"));
    CHECK_THAT(html, ContainsSubstring("1.2.3"));
    for (const char* foreign : {"http:", "https:", "<script>", "@import", "url(", "<link", "<iframe"}) CHECK(count(html, foreign) == 0);
    CHECK(count(html, "src=") == 2);
    CHECK_THAT(html, ContainsSubstring("<script type=\"application/json\">{\"title\":\"\\u003c/script>\\u003cb>\"}</script>"));
    CHECK_THAT(html, ContainsSubstring("download=\"yes-c.csv\" href=\"data:text/csv;base64," + paper::base64("x,y\n")));
    CHECK_THAT(html, ContainsSubstring("libjs-dygraphs"));
    dir.write("dygraph.min.js", "let dygraphs;");
    std::filesystem::create_directory(dir.path() / "extras");
    dir.write("extras/synchronizer.js", "let together;");
    head.charts_library = dir.path();
    const std::string live = paper::to_html(contents, results, rows, head);
    CHECK(count(live, "<script>") == 4);
    CHECK_THAT(live, ContainsSubstring("<script>let dygraphs;</script>"));
    const auto json = settings::parse_json(paper::to_json(results, rows, head));
    CHECK(json["config_hash"] == "abc");
    CHECK(json["comparisons"][1]["ours"] == 463.11);
    CHECK(json["comparisons"][2]["ours"].is_null());
    CHECK(json["comparisons"][0]["paper"].is_null());
    CHECK(json["sections"][1]["commands"][0]["status"] == 1);
}

TEST_CASE("the shipped report has every figure and table that is reproduced", "[STUDY-185]") {
    const paper::Contents contents = paper::load_contents("config/report.toml");
    std::string titles;
    std::set<std::string> pictures;
    for (const paper::Section& s : contents.sections) {
        titles += s.title + "\n";
        for (const paper::Picture& p : s.pictures) titles += p.caption + "\n";
        for (const std::string& line : s.commands) {
            CHECK((line.starts_with("rig-lab ") || line.starts_with("rig-replay ")));
            CHECK((line.find("{here}") != std::string::npos));
        }
    }
    for (const char* what : {"Fig. 3", "Fig. 5", "Fig. 6", "Fig. 7", "Fig. 8", "Fig. 9", "Fig. 10", "Fig. 11", "Fig. 12", "Fig. 13", "Fig. 14",
                             "Tables I and II", "Table III"})
        CHECK_THAT(titles, ContainsSubstring(what));
}
