#include "plant_sim/study/paper/output_html.hpp"

#include <algorithm>
#include <vector>

#include "plant_sim/study/paper/page.hpp"

namespace paper {

namespace {

std::vector<std::string_view> output_lines(std::string_view text) {
    std::vector<std::string_view> lines;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        lines.push_back(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return lines;
}

bool is_table_line(std::string_view line) {
    return line.starts_with('|');
}

/// `|---|---:|`
bool is_table_rule(std::string_view line) {
    return is_table_line(line) && line.find_first_not_of("|-: ") == std::string_view::npos;
}

std::string table_row(std::string_view line, const char* cell) {
    std::string out = "<tr>";
    line.remove_prefix(1);
    while (!line.empty()) {
        const std::size_t end = std::min(line.find('|'), line.size());
        std::string_view text = line.substr(0, end);
        line.remove_prefix(std::min(end + 1, line.size()));
        text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
        text = text.substr(0, text.find_last_not_of(' ') + 1);
        out += std::string("<") + cell + ">" + escaped(text) + "</" + cell + ">";
    }
    return out + "</tr>\n";
}

std::string table_html(const std::vector<std::string_view>& lines) {
    const bool headed = lines.size() > 1 && is_table_rule(lines[1]);
    std::string out = "<table class=\"output\">\n";
    if (headed) out += "<thead>" + table_row(lines.front(), "th") + "</thead>\n";
    out += "<tbody>\n";
    for (std::size_t i = headed ? 2 : 0; i < lines.size(); ++i) out += table_row(lines[i], "td");
    return out + "</tbody></table>\n";
}

std::string plain_html(const std::vector<std::string_view>& lines) {
    std::string text;
    for (const std::string_view line : lines) text.append(line).append("\n");
    const std::size_t first = text.find_first_not_of('\n');
    if (first == std::string::npos) return {};
    return "<pre>" + escaped(text.substr(first, text.find_last_not_of('\n') + 1 - first)) + "</pre>\n";
}

}  // namespace

std::string output_html(std::string_view output) {
    const std::vector<std::string_view> lines = output_lines(output);
    std::string out;
    for (auto begin = lines.begin(); begin != lines.end();) {
        const bool tabular = is_table_line(*begin);
        const auto end = std::find_if(begin, lines.end(), [&](std::string_view line) { return is_table_line(line) != tabular; });
        const std::vector<std::string_view> part(begin, end);
        out += tabular ? table_html(part) : plain_html(part);
        begin = end;
    }
    return out;
}

}  // namespace paper
