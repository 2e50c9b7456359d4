/// Inside the reader: what a document holds and how its tables look at it. Not for other rooms.
#pragma once

#include <toml++/toml.h>

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/host/settings/settings.hpp"

namespace settings {

struct Document::Content {
    std::string name;
    std::string text;
    toml::table root;
    /// The keys somebody knows, table by table.
    std::map<const toml::table*, std::set<std::string, std::less<>>> asked;
};

/// A table and where it stands.
struct Table::Scope {
    struct Unknown;

    std::shared_ptr<Document::Content> content;
    const toml::table* table = nullptr;
    std::string name;
    std::string path;

    /// Marks `key` as known; null when it is missing.
    [[nodiscard]] const toml::node* find(std::string_view key) const;
    /// As find(), but a missing key is refused, together with the key that seems to stand in its place.
    [[nodiscard]] const toml::node& get(std::string_view key) const;
    /// Keys that nobody knows so far.
    [[nodiscard]] std::vector<std::string_view> unknown_keys() const;
    /// Adds the keys of this table that nobody knows, and its tables under the keys that somebody knows.
    void inspect(std::vector<Unknown>& unknown, std::vector<Table>& known_tables) const;
    /// The table `node` of this one.
    [[nodiscard]] Table below(const toml::table& node, std::string_view key) const;
    /// Element `index` of the array of tables `key`.
    [[nodiscard]] Table below(const toml::table& node, std::string_view key, std::size_t index) const;

    [[nodiscard]] std::string path_of(std::string_view key) const;
    /// The line of `key`, or of this table when there is no such key; 0 for the root.
    [[nodiscard]] std::uint32_t line_of(std::string_view key) const;
    [[nodiscard]] std::uint32_t line() const;

    [[noreturn]] void reject(std::uint32_t line, std::string_view key, const std::string& message) const;
    [[noreturn]] void reject_unknown(std::string_view key) const;
    [[noreturn]] void reject_type(const toml::node& node, std::string_view key, std::string_view expected) const;
};

/// A key that nobody asked for.
struct Table::Scope::Unknown {
    toml::source_position place;
    Scope scope;
    std::string key;
};

/// `key` as TOML writes it, quoted where it must be.
[[nodiscard]] std::string spelt(std::string_view key);
/// "the string 'wet'", "the integer 3", "an array": what was found, for a message.
[[nodiscard]] std::string described(const toml::node& node);
/// The shortest decimal that is this number.
[[nodiscard]] std::string shown(double value);

}  // namespace settings
