#include "plant_sim/study/paper/page.hpp"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/number_in.hpp"
#include "plant_sim/study/paper/assets.hpp"
#include "plant_sim/study/paper/output_html.hpp"
#include "rig_bridge/panel/page.hpp"

namespace paper {

namespace {

namespace fs = std::filesystem;
using settings::Json;

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

/// An attribute of an SVG's first element; 0 where it has none.
int svg_size(std::string_view svg, std::string_view attribute) {
    const std::string begin = fmt::format(" {}=\"", attribute);
    const std::size_t at = svg.find(begin);
    int value = 0;
    if (at != std::string_view::npos) (void)std::from_chars(svg.data() + at + begin.size(), svg.data() + svg.size(), value);
    return value;
}

std::string if_there(const fs::path& file) {
    return fs::exists(file) ? bytes_of(file) : "";
}

/// The picture with the data of its chart, or with a table for download.
std::string figure(const Picture& picture, const SectionResult& result) {
    const fs::path file = result.directory / picture.file;
    std::string name = result.section->id + "-" + fs::path(picture.file).replace_extension().string();
    std::replace(name.begin(), name.end(), '/', '-');
    std::string parts;
    std::string link;
    try {
        const std::string svg = bytes_of(file);
        if (svg.find("<svg") == std::string::npos) throw std::runtime_error("is no SVG");
        parts = fmt::format("<img alt=\"{}\" width=\"{}\" height=\"{}\" src=\"data:image/svg+xml;base64,{}\">\n", escaped(picture.caption),
                            svg_size(svg, "width"), svg_size(svg, "height"), base64(svg));
        std::string charts = if_there(fs::path(file).replace_extension(".charts.json"));
        // Its text must not end the element.
        for (std::size_t at = charts.find('<'); at != std::string::npos; at = charts.find('<', at)) charts.replace(at, 1, "\\u003c");
        if (!charts.empty()) parts += "<script type=\"application/json\">" + charts + "</script>\n";
        const std::string table = charts.empty() ? if_there(fs::path(file).replace_extension(".csv")) : "";
        if (!table.empty())
            link =
                fmt::format(" <a class=\"csv\" download=\"{}.csv\" href=\"data:text/csv;base64,{}\">Data as CSV</a>", escaped(name), base64(table));
    } catch (const std::runtime_error& e) {
        parts = fmt::format("<div class=\"note\">The picture {} {}.</div>\n", escaped(picture.file), e.what());
    }
    return fmt::format("<figure id=\"{}\">\n{}<figcaption>{}{}</figcaption>\n<p class=\"made\">{}</p>\n</figure>\n", escaped(name), parts,
                       escaped(picture.caption), link, escaped(result.commands[picture.command].line));
}

/// Charts for viewing the page on a screen.
std::string scripts(const fs::path& library) {
    std::string out;
    for (const char* file : {"dygraph.min.js", "extras/synchronizer.js"}) {
        const std::string text = if_there(library / file);
        if (text.empty()) return "";
        out += "<script>" + text + "</script>\n";
    }
    return "<style>" + if_there(library / "dygraph.min.css") + "</style>\n" + out + "<script>" + rig::panel::kChartsJs + "</script>\n<script>" +
           kReportJs + "</script>\n";
}

/// The result of the section's commands, if it is not positive.
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
        if (w.printed) difference = fmt::format("{:+.{}f}", *c.ours - *w.printed, w.decimals);
        if (w.printed.value_or(0.0) != 0.0) share = fmt::format("{:+.2f} %", (*c.ours / *w.printed - 1.0) * 100.0);
    }
    return fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{}</td><td class=\"n\">{}{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
        escaped(w.quantity), escaped(w.unit), escaped(w.source), w.relation.empty() ? "" : escaped(w.relation) + " ",
        w.printed ? printed(*w.printed, w.decimals) : "-", ours, difference, share);
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
    out += s.html;
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

/// Text of a result file; a configuration file is converted to JSON.
std::string json_in(std::string_view file, const fs::path& directory, const fs::path& config) {
    constexpr std::string_view kConfig = "{config}/";
    const fs::path path = file.starts_with(kConfig) ? config / file.substr(kConfig.size()) : directory / file;
    std::string text = bytes_of(path);
    if (path.extension() != ".toml") return text;
    std::ostringstream json;
    json << toml::json_formatter(toml::parse(text));
    return json.str();
}

/// The element of `at` named by `step`: "name", "12", or "name[key=value]" without the name.
const Json& element(const Json& at, const std::string& step, std::string_view path) {
    const auto missing = [&]() -> const Json& { throw std::runtime_error(fmt::format("nothing at {} (no '{}')", path, step)); };
    if (at.is_array()) {
        const auto index = settings::number_in<std::size_t>(step);
        return index && *index < at.size() ? at[*index] : missing();
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
    const Json root = settings::parse_json(json);
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

std::vector<Compared> compared(const std::vector<SectionResult>& results, const fs::path& config) {
    std::vector<Compared> rows;
    for (const SectionResult& result : results)
        for (const Comparison& c : result.section->comparisons) {
            Compared row{.what = &c, .ours = std::nullopt, .why = {}};
            try {
                row.ours = value_at(json_in(c.file, result.directory, config), c.at);
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
    // nlohmann's replacement of invalid UTF-8, then the five characters of HTML.
    const std::string quoted = Json(std::string(text)).dump(-1, ' ', false, Json::error_handler_t::replace);
    const std::string clean = settings::parse_json(quoted).get<std::string>();
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
        "initial-scale=1\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'; "
        "script-src 'unsafe-inline'\">\n<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<main>\n"
        "<h1>{0}</h1>\n<p class=\"head\">version {2} &middot; configuration {3}</p>\n<p class=\"made\">{4}</p>\n",
        escaped(contents.title), kReportCss, escaped(head.version), escaped(head.config_hash), escaped(head.command));
    if (head.quick)
        out +=
            "<div class=\"note\">This is the quick form: fewer stops, starts and maneuvers than the studies need. Its figures are rougher than those "
            "of the report itself.</div>\n";
    const std::string charts = scripts(head.charts_library);
    out += charts.empty() ? "<p class=\"head\">Charts that zoom need the package libjs-dygraphs where the report is made; these are pictures.</p>\n"
                          : "<p class=\"head help\">Drag over a chart to zoom, hold shift and drag to pan, double-click to see all; point at it for "
                            "values. Of long series each of 300 parts keeps its first, last, least and greatest value.</p>\n";
    out += paragraphs(contents.text) + "<nav><ol>\n";
    for (const SectionResult& r : results) {
        const char* state = r.failed() ? " (failed)" : r.passed() ? "" : " (answers no)";
        fmt::format_to(std::back_inserter(out), "<li><a href=\"#{}\">{}</a>{}</li>\n", r.section->id, escaped(r.section->title), state);
    }
    out += "</ol></nav>\n";
    if (!rows.empty()) out += "<h2>The paper and this project</h2>\n" + comparison_table(rows);
    for (const SectionResult& r : results) out += section_html(r, rows);
    return out + "</main>\n" + charts + "</body>\n</html>\n";
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
        Json row{{"quantity", c.what->quantity},
                 {"unit", c.what->unit},
                 {"source", c.what->source},
                 {"paper", c.what->printed ? Json(*c.what->printed) : Json()}};
        row["ours"] = c.ours ? Json(*c.ours) : Json();
        comparisons.push_back(row);
    }
    const Json json{{"study", "report"},   {"version", head.version}, {"config_hash", head.config_hash},
                    {"quick", head.quick}, {"sections", sections},    {"comparisons", comparisons}};
    return settings::json_page(json);
}

}  // namespace paper
