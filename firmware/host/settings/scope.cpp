#include <algorithm>
#include <array>
#include <charconv>

#include "firmware/host/settings/content.hpp"
#include "firmware/host/settings/near_miss.hpp"

namespace settings {

namespace {

std::string shortened(std::string_view text) {
    constexpr std::size_t kMaxBytes = 60;
    if (text.size() <= kMaxBytes) return printable(text);
    auto end = kMaxBytes;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;  // not inside a UTF-8 character
    return printable(text.substr(0, end)) + "...";
}

std::string wrong_unit(std::string_view expected, std::string_view got) {
    return "unit: expected " + printable(expected) + ", got " + printable(got);
}

}  // namespace

std::string spelt(std::string_view key) {
    const auto is_bare = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-'; };
    if (!key.empty() && std::all_of(key.begin(), key.end(), is_bare)) return std::string(key);
    return std::string("\"").append(printable(key)).append("\"");
}

std::string shown(double value) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    return {digits.data(), end};
}

std::string described(const toml::node& node) {
    switch (node.type()) {
        case toml::node_type::string:
            return "the string '" + shortened(node.as_string()->get()) + "'";
        case toml::node_type::integer:
            return "the integer " + std::to_string(node.as_integer()->get());
        case toml::node_type::floating_point:
            return "the number " + shown(node.as_floating_point()->get());
        case toml::node_type::boolean:
            return node.as_boolean()->get() ? "the boolean true" : "the boolean false";
        case toml::node_type::array:
            return "an array";
        case toml::node_type::table:
            return "a table";
        default:
            return "a date or time";
    }
}

const toml::node* Table::Scope::find(std::string_view key) const {
    content->asked[table].emplace(key);
    return table->get(key);
}

const toml::node& Table::Scope::get(std::string_view key) const {
    if (const auto* node = find(key)) return *node;
    const auto candidates = unknown_keys();
    for (const auto candidate : candidates) {
        if (differs_in_unit(key, candidate)) reject(line_of(candidate), candidate, wrong_unit(key, candidate));
    }
    if (const auto near = nearest(key, candidates); !near.empty()) reject(line_of(near), key, "missing; is '" + printable(near) + "' a slip of it?");
    reject(line(), key, "missing");
}

void Table::Scope::inspect(std::vector<Unknown>& unknown, std::vector<Table>& known_tables) const {
    const auto& known = content->asked[table];
    for (const auto& [key, node] : *table) {
        if (!known.contains(key.str())) {
            unknown.push_back({key.source().begin, *this, std::string(key.str())});
        } else if (const auto* one = node.as_table()) {
            known_tables.push_back(below(*one, key.str()));
        } else if (const auto* many = node.as_array()) {
            for (std::size_t index = 0; index < many->size(); ++index) {
                if (const auto* element = many->get(index)->as_table()) known_tables.push_back(below(*element, key.str(), index));
            }
        }
    }
}

Table Table::Scope::below(const toml::table& node, std::string_view key) const {
    return Table(std::make_shared<const Scope>(Scope{content, &node, std::string(key), path_of(key)}));
}

Table Table::Scope::below(const toml::table& node, std::string_view key, std::size_t index) const {
    const auto position = std::string("[").append(std::to_string(index)).append("]");
    return Table(std::make_shared<const Scope>(Scope{content, &node, std::string(key) + position, path_of(key) + position}));
}

std::string Table::Scope::path_of(std::string_view key) const {
    if (key.empty()) return path;
    return path.empty() ? spelt(key) : path + "." + spelt(key);
}

std::uint32_t Table::Scope::line_of(std::string_view key) const {
    const auto entry = table->find(key);
    return entry == table->end() ? line() : entry->first.source().begin.line;
}

std::uint32_t Table::Scope::line() const {
    return path.empty() ? 0 : table->source().begin.line;
}

std::vector<std::string_view> Table::Scope::unknown_keys() const {
    const auto& known = content->asked[table];
    std::vector<std::string_view> unknown;
    for (const auto& [key, node] : *table) {
        if (!known.contains(key.str())) unknown.push_back(key.str());
    }
    return unknown;
}

void Table::Scope::reject(std::uint32_t line, std::string_view key, const std::string& message) const {
    throw Error(content->name, line, path_of(key), message);
}

void Table::Scope::reject_unknown(std::string_view key) const {
    std::vector<std::string_view> missing;
    std::vector<std::string_view> known;
    for (const auto& asked : content->asked[table]) {
        known.emplace_back(asked);
        if (!table->contains(asked)) missing.emplace_back(asked);
    }
    for (const auto expected : missing) {
        if (differs_in_unit(expected, key)) reject(line_of(key), key, wrong_unit(expected, key));
    }
    auto near = nearest(key, missing);
    if (near.empty()) near = nearest(key, known);
    reject(line_of(key), key,
           std::string("unknown ") + (table->get(key)->is_table() ? "table" : "key") +
               (near.empty() ? "" : "; did you mean '" + printable(near) + "'?"));
}

void Table::Scope::reject_type(const toml::node& node, std::string_view key, std::string_view expected) const {
    reject(node.source().begin.line, key, "expected " + std::string(expected) + ", got " + described(node));
}

}  // namespace settings
