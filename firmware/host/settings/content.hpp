/// Internal to settings/: the content of a document and the access of its tables to it.
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
    /// Keys that a caller has asked for, by table.
    std::map<const toml::table*, std::set<std::string, std::less<>>> asked;
};

/// A table and its position in the document.
struct Table::Scope {
    struct Unknown;

    std::shared_ptr<Document::Content> content;
    const toml::table* table = nullptr;
    std::string name;
    std::string path;

    /// Marks `key` as known; null if it is missing.
    [[nodiscard]] const toml::node* find(std::string_view key) const;
    /// As find(), but throws for a missing key; the error names an unknown key that may be a misspelling of it.
    [[nodiscard]] const toml::node& get(std::string_view key) const;
    /// Keys that no caller has asked for so far.
    [[nodiscard]] std::vector<std::string_view> unknown_keys() const;
    /// Adds the unknown keys of this table to `unknown`, and its tables under known keys to `known_tables`.
    void inspect(std::vector<Unknown>& unknown, std::vector<Table>& known_tables) const;
    /// The table `node` of this one.
    [[nodiscard]] Table below(const toml::table& node, std::string_view key) const;
    /// Element `index` of the array of tables `key`.
    [[nodiscard]] Table below(const toml::table& node, std::string_view key, std::size_t index) const;

    [[nodiscard]] std::string path_of(std::string_view key) const;
    /// The line of `key`, or of this table if there is no such key; 0 for the root.
    [[nodiscard]] std::uint32_t line_of(std::string_view key) const;
    [[nodiscard]] std::uint32_t line() const;

    [[noreturn]] void reject(std::uint32_t line, std::string_view key, const std::string& message) const;
    [[noreturn]] void reject_unknown(std::string_view key) const;
    [[noreturn]] void reject_type(const toml::node& node, std::string_view key, std::string_view expected) const;
};

/// A key that no caller has asked for.
struct Table::Scope::Unknown {
    toml::source_position place;
    Scope scope;
    std::string key;
};

/// `key` as TOML writes it, quoted where it must be.
[[nodiscard]] std::string spelt(std::string_view key);
/// "the string 'wet'", "the integer 3", "an array": what was found, for a message.
[[nodiscard]] std::string described(const toml::node& node);
/// The shortest decimal that reads back as this number.
[[nodiscard]] std::string shown(double value);

}  // namespace settings
