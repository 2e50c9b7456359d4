#include "plant_sim/study/paper/page.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "plant_sim/study/paper/output_html.hpp"

namespace paper {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kStyle = R"(
:root { --ink: #1c2733; --soft: #5b6773; --line: #d5dbe1; --blue: #1f4e79; --orange: #c55a11; --ground: #f5f7f9; }
* { box-sizing: border-box; }
body { margin: 0; color: var(--ink); background: #fff; font: 16px/1.55 Georgia, "DejaVu Serif", "Times New Roman", serif; }
main { max-width: 62rem; margin: 0 auto; padding: 2.5rem 1.5rem 4rem; }
h1 { font-size: 2rem; line-height: 1.2; margin: 0 0 .6rem; color: var(--blue); }
h2 { font-size: 1.35rem; margin: 3rem 0 .6rem; padding-top: .6rem; border-top: 2px solid var(--blue); color: var(--blue); }
p { margin: .6rem 0; max-width: 48rem; }
.head { color: var(--soft); font: 13px/1.5 "DejaVu Sans", Helvetica, Arial, sans-serif; }
nav ol { columns: 2; column-gap: 3rem; font: 14px/1.7 "DejaVu Sans", Helvetica, Arial, sans-serif; padding-left: 1.5rem; }
a { color: var(--blue); text-decoration: none; }
figure { margin: 1.4rem 0; break-inside: avoid; }
figure img { display: block; width: 100%; max-width: 1100px; height: auto; border: 1px solid var(--line); }
figcaption { font: 14px/1.5 "DejaVu Sans", Helvetica, Arial, sans-serif; margin-top: .5rem; }
.made { color: var(--soft); font: 12px/1.5 "DejaVu Sans Mono", Consolas, monospace; overflow-wrap: anywhere; margin: .2rem 0 0; }
.made::before { content: "$ "; color: var(--orange); }
table { border-collapse: collapse; width: 100%; font: 14px/1.45 "DejaVu Sans", Helvetica, Arial, sans-serif; margin: 1rem 0; }
th, td { padding: .35rem .6rem; border-bottom: 1px solid var(--line); text-align: left; vertical-align: top; }
th { background: var(--ground); border-bottom: 2px solid var(--blue); }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
tr { break-inside: avoid; }
table.output { font-size: 12px; font-variant-numeric: tabular-nums; }
table.output th, table.output td { padding: .15rem .3rem; }
table.output td { white-space: nowrap; }
pre { background: var(--ground); border: 1px solid var(--line); padding: .8rem 1rem; white-space: pre-wrap;
      font: 12px/1.45 "DejaVu Sans Mono", Consolas, monospace; margin: 1rem 0; }
.note { border-left: 4px solid var(--orange); background: #fdf3ec; padding: .6rem 1rem; margin: 1rem 0;
        font: 14px/1.5 "DejaVu Sans", Helvetica, Arial, sans-serif; break-inside: avoid; }
.note pre { background: #fff; margin: .5rem 0 0; }
@page { size: A4; margin: 16mm 14mm; }
@media print {
  body { font-size: 10.5pt; }
  main { max-width: none; padding: 0; }
  section { break-before: page; }
  h2 { margin-top: 0; break-after: avoid; }
  .next { break-after: avoid; }
  pre { font-size: 6.6pt; break-inside: auto; }
  figure img { max-height: 178mm; width: auto; max-width: 100%; margin: 0 auto; }
  table { font-size: 8.5pt; }
  table.output { font-size: 6.6pt; }
  table.output th, table.output td { padding: .05rem .28rem; }
  th, td { padding: .15rem .4rem; }
  a { color: inherit; }
}
)";

std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw std::runtime_error("is not there");
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::string paragraphs(const std::string& text) {
    std::string out;
    std::size_t from = 0;
    while (from < text.size()) {
        const std::size_t end = std::min(text.find("\n\n", from), text.size());
        const std::string part = text.substr(from, end - from);
        if (part.find_first_not_of(" \n") != std::string::npos) fmt::format_to(std::back_inserter(out), "<p>{}</p>\n", escaped(part));
        from = end + 2;
    }
    return out;
}

/// Width and height from a PNG's first chunk, so that the page does not move while it is read; none when it is no PNG.
std::optional<std::array<unsigned, 2>> size_of_png(std::string_view bytes) {
    constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
    constexpr std::size_t kWidthAt = 16;
    constexpr std::size_t kEnd = 24;
    if (!bytes.starts_with(kSignature) || bytes.size() < kEnd) return std::nullopt;
    std::array<unsigned, 2> size{};
    for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t k = 0; k < 4; ++k) size[i] = (size[i] << 8U) | static_cast<unsigned char>(bytes[kWidthAt + 4 * i + k]);
    return size;
}

std::string figure(const Picture& picture, const SectionResult& result) {
    const std::string caption = fmt::format("<figcaption>{}</figcaption>\n<p class=\"made\">{}</p>\n", escaped(picture.caption),
                                            escaped(result.commands[picture.command].line));
    try {
        const std::string bytes = bytes_of(result.directory / picture.file);
        const auto size = size_of_png(bytes);
        if (!size) throw std::runtime_error("is no PNG");
        return fmt::format("<figure>\n<img alt=\"{}\" width=\"{}\" height=\"{}\" src=\"data:image/png;base64,{}\">\n{}</figure>\n",
                           escaped(picture.caption), (*size)[0], (*size)[1], base64(bytes), caption);
    } catch (const std::runtime_error& e) {
        return fmt::format("<figure>\n<div class=\"note\">The picture {} {}.</div>\n{}</figure>\n", escaped(picture.file), e.what(), caption);
    }
}

/// What the section's commands answered, where that is not yes.
std::string verdict(const SectionResult& result) {
    std::string out;
    for (const CommandResult& c : result.commands) {
        if (c.status == 0) continue;
        std::string said = c.errors;
        const auto last = said.find_last_not_of(" \n\r\t");
        said.resize(last == std::string::npos ? 0 : last + 1);
        const char* what = c.status == 1  ? "The answer of this study is no (exit status 1)."
                           : c.status < 0 ? "This command was not run."
                                          : "This command failed; what depends on it is missing.";
        fmt::format_to(std::back_inserter(out), "<div class=\"note\">{}<p class=\"made\">{}</p>{}</div>\n", what, escaped(c.line),
                       said.empty() ? "" : "<pre>" + escaped(said) + "</pre>");
    }
    return out;
}

std::string printed(double value, int decimals) {
    return fmt::format("{:.{}f}", value, decimals);
}

std::string comparison_row(const Compared& c) {
    const Comparison& w = *c.what;
    std::string ours = "-";
    std::string difference = "-";
    std::string share = "-";
    if (c.ours) {
        ours = printed(*c.ours, w.decimals);
        difference = fmt::format("{:+.{}f}", *c.ours - w.printed, w.decimals);
        if (w.printed != 0.0) share = fmt::format("{:+.2f} %", (*c.ours / w.printed - 1.0) * 100.0);
    }
    return fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{}</td><td class=\"n\">{}{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
        escaped(w.quantity), escaped(w.unit), escaped(w.source), w.relation.empty() ? "" : escaped(w.relation) + " ", printed(w.printed, w.decimals),
        ours, difference, share);
}

std::string comparison_table(const std::vector<Compared>& rows) {
    std::string out =
        "<table>\n<thead><tr><th>quantity</th><th>unit</th><th>in the paper</th><th class=\"n\">paper</th><th class=\"n\">here</th><th "
        "class=\"n\">difference</th><th class=\"n\">relative</th></tr></thead>\n<tbody>\n";
    for (const Compared& c : rows) out += comparison_row(c);
    out += "</tbody></table>\n";
    for (const Compared& c : rows)
        if (!c.ours) fmt::format_to(std::back_inserter(out), "<div class=\"note\">{}: {}</div>\n", escaped(c.what->quantity), escaped(c.why));
    return out;
}

std::string section_html(const SectionResult& result, const std::vector<Compared>& rows) {
    const Section& s = *result.section;
    std::string out = fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}{}", s.id, escaped(s.title), paragraphs(s.text), verdict(result));
    for (const Picture& p : s.pictures) out += figure(p, result);
    std::vector<Compared> own;
    for (const Compared& c : rows)
        if (c.what >= s.comparisons.data() && c.what < s.comparisons.data() + s.comparisons.size()) own.push_back(c);
    if (!own.empty()) out += comparison_table(own);
    const bool said = result.commands.size() == 1 && !s.pictures.empty();  // under its picture
    for (const std::size_t i : s.shown) {
        const CommandResult& c = result.commands[i];
        if (c.output.empty()) continue;
        if (!said) fmt::format_to(std::back_inserter(out), "<p class=\"made\">{}</p>\n", escaped(c.line));
        out += output_html(c.output);
    }
    out += result.commands.size() > 1 ? "<p class=\"head next\">All commands of this section:</p>\n" : "";
    for (const CommandResult& c : result.commands)
        if (result.commands.size() > 1) fmt::format_to(std::back_inserter(out), "<p class=\"made\">{}</p>\n", escaped(c.line));
    return out + "</section>\n";
}

/// The element that `step` names, "name", "12" or "name[key=value]" without its name.
const Json& element(const Json& at, const std::string& step, std::string_view path) {
    const auto missing = [&]() -> const Json& { throw std::runtime_error(fmt::format("nothing at {} (no '{}')", path, step)); };
    if (at.is_array()) {
        std::size_t index = 0;
        const auto [end, error] = std::from_chars(step.data(), step.data() + step.size(), index);
        if (error != std::errc{} || end != step.data() + step.size() || index >= at.size()) return missing();
        return at[index];
    }
    const auto found = at.find(step);
    return found == at.end() ? missing() : *found;
}

const Json& selected(const Json& array, const std::string& rule, std::string_view path) {
    const auto equals = rule.find('=');
    const std::string key = rule.substr(0, equals);
    const std::string value = equals == std::string::npos ? "" : rule.substr(equals + 1);
    double wanted = std::nan("");
    (void)std::from_chars(value.data(), value.data() + value.size(), wanted);
    constexpr double kSame = 1e-9;
    for (const Json& one : array) {
        const auto at = one.find(key);
        if (at == one.end()) continue;
        if (at->is_string() && at->get<std::string>() == value) return one;
        if (at->is_number() && std::abs(at->get<double>() - wanted) <= kSame) return one;
    }
    throw std::runtime_error(fmt::format("nothing at {} (no element with {})", path, rule));
}

}  // namespace

double value_at(std::string_view json, std::string_view path) {
    const Json root = Json::parse(json);
    const Json* at = &root;
    const bool size_wanted = path.ends_with("/#");
    if (size_wanted) path.remove_suffix(2);
    for (std::size_t from = 0; from < path.size();) {
        if (path[from] != '/') throw std::runtime_error(fmt::format("{}: steps begin with /", path));
        const std::size_t end = std::min(path.find('/', from + 1), path.size());
        std::string step(path.substr(from + 1, end - from - 1));
        from = end;
        std::string rule;
        if (const auto bracket = step.find('['); bracket != std::string::npos && step.ends_with(']')) {
            rule = step.substr(bracket + 1, step.size() - bracket - 2);
            step.resize(bracket);
        }
        at = &element(*at, step, path);
        if (!rule.empty()) at = &selected(*at, rule, path);
    }
    if (size_wanted && at->is_array()) return static_cast<double>(at->size());
    if (!at->is_number()) throw std::runtime_error(fmt::format("what is at {} is no number", path));
    return at->get<double>();
}

std::vector<Compared> compared(const std::vector<SectionResult>& results) {
    std::vector<Compared> rows;
    for (const SectionResult& result : results)
        for (const Comparison& c : result.section->comparisons) {
            Compared row{.what = &c, .ours = std::nullopt, .why = {}};
            try {
                row.ours = value_at(bytes_of(result.directory / c.file), c.at);
            } catch (const std::exception& e) {
                row.why = c.file + ": " + e.what();
            }
            rows.push_back(row);
        }
    return rows;
}

std::string base64(std::string_view bytes) {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = std::min<std::size_t>(bytes.size() - i, 3);
        unsigned group = 0;
        for (std::size_t k = 0; k < 3; ++k) group = (group << 8U) | (k < left ? static_cast<unsigned char>(bytes[i + k]) : 0U);
        for (std::size_t k = 0; k < 4; ++k) out += k <= left ? kDigits[(group >> (18U - 6U * k)) & 63U] : '=';
    }
    return out;
}

std::string escaped(std::string_view text) {
    // nlohmann's replacing of what is no UTF-8, and then the five characters of HTML.
    const std::string quoted = Json(std::string(text)).dump(-1, ' ', false, Json::error_handler_t::replace);
    const std::string clean = Json::parse(quoted).get<std::string>();
    std::string out;
    out.reserve(clean.size());
    for (const char c : clean) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&#39;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

std::string to_html(const Contents& contents, const std::vector<SectionResult>& results, const std::vector<Compared>& rows, const PageHead& head) {
    std::string out = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, "
        "initial-scale=1\">\n<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<main>\n"
        "<h1>{0}</h1>\n<p class=\"head\">version {2} &middot; configuration {3}</p>\n<p class=\"made\">{4}</p>\n",
        escaped(contents.title), kStyle, escaped(head.version), escaped(head.config_hash), escaped(head.command));
    if (head.quick)
        out +=
            "<div class=\"note\">This is the quick form: fewer stops, starts and maneuvers than the studies need. Its figures are rougher than those "
            "of the report itself.</div>\n";
    out += paragraphs(contents.text) + "<nav><ol>\n";
    for (const SectionResult& r : results) {
        const char* state = r.failed() ? " (failed)" : r.answered_yes() ? "" : " (answers no)";
        fmt::format_to(std::back_inserter(out), "<li><a href=\"#{}\">{}</a>{}</li>\n", r.section->id, escaped(r.section->title), state);
    }
    out += "</ol></nav>\n";
    if (!rows.empty()) out += "<h2>The paper and this project</h2>\n" + comparison_table(rows);
    for (const SectionResult& r : results) out += section_html(r, rows);
    return out + "</main>\n</body>\n</html>\n";
}

std::string to_json(const std::vector<SectionResult>& results, const std::vector<Compared>& rows, const PageHead& head) {
    Json sections = Json::array();
    for (const SectionResult& r : results) {
        Json commands = Json::array();
        for (const CommandResult& c : r.commands) commands.push_back({{"command", c.line}, {"status", c.status}});
        sections.push_back({{"id", r.section->id}, {"title", r.section->title}, {"commands", commands}});
    }
    Json comparisons = Json::array();
    for (const Compared& c : rows) {
        Json row{{"quantity", c.what->quantity}, {"unit", c.what->unit}, {"source", c.what->source}, {"paper", c.what->printed}};
        row["ours"] = c.ours ? Json(*c.ours) : Json();
        comparisons.push_back(row);
    }
    const Json json{{"study", "report"},   {"version", head.version}, {"config_hash", head.config_hash},
                    {"quick", head.quick}, {"sections", sections},    {"comparisons", comparisons}};
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace paper
