#include "plant_sim/study/paper/sections.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "firmware/host/settings/settings.hpp"

namespace paper {

namespace {

using settings::Table;

/// Lines without the empty ones and the space around them.
std::vector<std::string> lines_of(const std::string& text) {
    constexpr const char* kSpace = " \t\r\n";
    std::vector<std::string> lines;
    for (std::size_t from = 0; from < text.size();) {
        const std::size_t end = std::min(text.find('\n', from), text.size());
        const std::size_t first = text.find_first_not_of(kSpace, from);
        if (first < end) lines.push_back(text.substr(first, text.find_last_not_of(kSpace, end - 1) + 1 - first));
        from = end + 1;
    }
    return lines;
}

bool is_name(const std::string& id) {
    return std::all_of(id.begin(), id.end(), [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; });
}

/// Index of a command by its number from 1; the last one if the key is missing.
std::size_t command_of(const Table& t, std::string_view key, std::size_t commands) {
    const auto last = static_cast<std::int64_t>(commands);
    return static_cast<std::size_t>(t.find_integer(key, {.min = 1, .max = last}).value_or(last) - 1);
}

Comparison comparison(const Table& t) {
    return {.quantity = t.text("quantity"),
            .unit = t.find_text("unit").value_or(""),
            .source = t.text("source"),
            .relation = t.find_text("relation").value_or(""),
            .printed = t.find_number("paper"),
            .file = t.text("file"),
            .at = t.text("at"),
            .decimals = t.find_integer<int>("decimals", {.min = 0, .max = 9}).value_or(3)};
}

Section section(const Table& t, const std::vector<Section>& earlier) {
    Section s;
    s.id = t.text("id");
    if (!is_name(s.id)) t.fail("id", "names a directory: letters, digits, _ and - only");
    const auto is = [](const std::string& id) { return [&id](const Section& other) { return other.id == id; }; };
    if (std::any_of(earlier.begin(), earlier.end(), is(s.id))) t.fail("id", "there are two sections '" + s.id + "'");
    s.title = t.text("title");
    s.text = t.find_text("text").value_or("");
    s.after = t.find_text("after").value_or("");
    if (!s.after.empty() && std::none_of(earlier.begin(), earlier.end(), is(s.after)))
        t.fail("after", "'" + s.after + "' is no section above this one");
    s.html = t.find_text("html").value_or("");
    s.commands = lines_of(s.html.empty() ? t.text("commands") : t.find_text("commands").value_or(""));
    if (s.commands.empty() && (s.html.empty() || !s.after.empty() || !t.tables("picture", {.min = 0}).empty()))
        t.fail("commands", "has no command; one a line");
    s.quick_commands = lines_of(t.find_text("quick_commands").value_or(""));
    if (!s.quick_commands.empty() && s.quick_commands.size() != s.commands.size()) t.fail("quick_commands", "must be as many as commands");
    const auto last = static_cast<double>(s.commands.size());
    for (const double shown : t.find_numbers("show", {.range = {.min = 1.0, .max = last}, .count = {.min = 0}}).value_or(std::vector<double>{}))
        s.shown.push_back(static_cast<std::size_t>(std::llround(shown)) - 1);
    for (const Table& p : t.tables("picture", {.min = 0}))
        s.pictures.push_back({.file = p.text("file"), .caption = p.text("caption"), .command = command_of(p, "command", s.commands.size())});
    for (const Table& c : t.tables("compare", {.min = 0})) s.comparisons.push_back(comparison(c));
    return s;
}

}  // namespace

Contents load_contents(const std::filesystem::path& file) {
    const settings::Document doc = settings::Document::load(file);
    const Table root = doc.root();
    Contents contents{.title = root.text("title"), .text = root.find_text("text").value_or(""), .sections = {}};
    for (const Table& t : root.tables("section")) contents.sections.push_back(section(t, contents.sections));
    doc.finish();
    return contents;
}

}  // namespace paper
