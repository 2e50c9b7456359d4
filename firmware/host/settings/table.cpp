#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "firmware/host/settings/content.hpp"
#include "firmware/host/settings/near_miss.hpp"

namespace settings {

namespace {

/// An end of a range for a message; "" when the range is open there.
std::string end_of(double value) {
    return std::isfinite(value) ? shown(value) : "";
}
std::string end_of(std::int64_t value) {
    using Limits = std::numeric_limits<std::int64_t>;
    return value == Limits::min() || value == Limits::max() ? "" : std::to_string(value);
}
std::string end_of(std::size_t value) {
    return value == std::numeric_limits<std::size_t>::max() ? "" : std::to_string(value);
}

/// Why `value`, written `text`, is refused by `range`; "" when it is not.
template <typename T, typename R>
std::string out_of(T value, const std::string& text, const R& range) {
    if (value >= range.min && value <= range.max) return {};
    const auto min = end_of(range.min);
    const auto max = end_of(range.max);
    if (!min.empty() && !max.empty()) return text + " is out of range " + min + " to " + max;
    return min.empty() ? text + " is above " + max : text + " is below " + min;
}

std::string wrong_count(std::size_t count, const Count& allowed, const std::string& what) {
    const auto reason = out_of(count, std::to_string(count), allowed);
    return reason.empty() ? reason : "the number of " + what + ", " + reason;
}

/// `node` as number() takes it; `refuse(message)` throws.
template <typename Refuse>
double number_of(const toml::node& node, const Range& range, const Refuse& reject) {
    if (!node.is_number()) reject("expected a number, got " + described(node));
    const double value = node.is_integer() ? static_cast<double>(node.as_integer()->get()) : node.as_floating_point()->get();
    if (!std::isfinite(value)) reject("expected a finite number, got " + shown(value));
    if (const auto reason = out_of(value, shown(value), range); !reason.empty()) reject(reason);
    return value;
}

std::string listed(std::span<const std::string_view> names) {
    std::string list;
    for (const auto name : names) list += (list.empty() ? "'" : ", '") + std::string(name) + "'";
    return list;
}

}  // namespace

double Table::number(std::string_view key, const Range& range) const {
    const auto& node = scope_->get(key);
    return number_of(node, range, [&](const std::string& message) { scope_->reject(node.source().begin.line, key, message); });
}

std::int64_t Table::integer_within(std::string_view key, const IntegerRange& range) const {
    const auto& node = scope_->get(key);
    if (!node.is_integer()) scope_->reject_type(node, key, "an integer");
    const auto value = node.as_integer()->get();
    if (const auto reason = out_of(value, std::to_string(value), range); !reason.empty()) fail(key, reason);
    return value;
}

bool Table::boolean(std::string_view key) const {
    const auto& node = scope_->get(key);
    if (!node.is_boolean()) scope_->reject_type(node, key, "true or false");
    return node.as_boolean()->get();
}

std::string Table::text(std::string_view key) const {
    const auto& node = scope_->get(key);
    if (!node.is_string()) scope_->reject_type(node, key, "a string");
    auto value = node.as_string()->get();
    if (value.empty()) fail(key, "expected a string of at least one character");
    return value;
}

std::size_t Table::index_of_choice(std::string_view key, std::span<const std::string_view> names) const {
    const auto& node = scope_->get(key);
    if (!node.is_string()) scope_->reject_type(node, key, "one of " + listed(names));
    const auto& word = node.as_string()->get();
    const auto found = std::find(names.begin(), names.end(), word);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    const auto near = nearest(word, names);
    fail(key, described(node) + " is not one of " + listed(names) + (near.empty() ? "" : "; did you mean '" + std::string(near) + "'?"));
}

std::vector<double> Table::numbers(std::string_view key, const NumbersRule& rule) const {
    const auto& node = scope_->get(key);
    const auto* array = node.as_array();
    if (array == nullptr) scope_->reject_type(node, key, "an array of numbers");
    std::vector<double> values;
    for (const auto& element : *array) {
        const auto reject = [&](const std::string& message) {
            throw Error(file(), element.source().begin.line, scope_->path_of(key) + "[" + std::to_string(values.size()) + "]", message);
        };
        const double value = number_of(element, rule.range, reject);
        if (rule.strictly_increasing && !values.empty() && value <= values.back())
            reject(shown(value) + " is not above " + shown(values.back()) + ", the number before it");
        values.push_back(value);
    }
    if (const auto reason = wrong_count(values.size(), rule.count, "numbers"); !reason.empty()) fail(key, reason);
    return values;
}

Table Table::table(std::string_view key) const {
    const auto& node = scope_->get(key);
    if (!node.is_table()) scope_->reject_type(node, key, "a table");
    return scope_->below(*node.as_table(), key);
}

std::vector<Table> Table::tables(std::string_view key, const Count& count) const {
    if (count.min == 0 && !has(key)) return {};
    const auto& node = scope_->get(key);
    if (node.is_table()) return scope_->below(*node.as_table(), key).tables(count);
    const auto* array = node.as_array();
    if (array == nullptr) scope_->reject_type(node, key, "tables");
    std::vector<Table> found;
    for (const auto& element : *array) {
        if (!element.is_table()) scope_->reject_type(element, key, "an array of tables only");
        found.push_back(scope_->below(*element.as_table(), key, found.size()));
    }
    if (const auto reason = wrong_count(found.size(), count, "tables"); !reason.empty()) fail(key, reason);
    return found;
}

std::vector<Table> Table::tables(const Count& count) const {
    std::vector<std::pair<toml::source_position, Table>> placed;
    for (const auto& [key, unused] : *scope_->table) {
        const auto& node = scope_->get(key.str());
        if (!node.is_table()) scope_->reject_type(node, key.str(), "a table");
        placed.emplace_back(key.source().begin, scope_->below(*node.as_table(), key.str()));
    }
    std::sort(placed.begin(), placed.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Table> found;
    found.reserve(placed.size());
    for (auto& [position, table] : placed) found.push_back(std::move(table));
    if (const auto reason = wrong_count(found.size(), count, "tables"); !reason.empty()) fail("", reason);
    return found;
}

bool Table::has(std::string_view key) const {
    return scope_->find(key) != nullptr;
}

const std::string& Table::name() const {
    return scope_->name;
}
const std::string& Table::path() const {
    return scope_->path;
}
const std::string& Table::file() const {
    return scope_->content->name;
}

void Table::fail(std::string_view key, const std::string& message) const {
    scope_->reject(scope_->line_of(key), key, message);
}

}  // namespace settings
