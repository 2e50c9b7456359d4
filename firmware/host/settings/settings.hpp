/// Reads settings from TOML files. Key, type and range are declared where the value is read; undeclared keys are refused.
///
///     const auto doc = settings::Document::load("config/plant.toml");
///     const auto wheel = doc.root().table("wheel");
///     const double J_w = wheel.number("inertia_kgm2", {.min = 0.01, .max = 100.0});
///     const auto teeth = wheel.integer<std::uint16_t>("teeth", {.min = 1, .max = 1000});
///     const auto k_x = wheel.find_number("k_x_Npm", {.min = 0.0});  // optional
///     for (const auto& surface : doc.root().table("surfaces").tables()) { use(surface.name(),
///     surface.number("c1", ...)); } doc.finish();  // refuses every key that nobody asked for
///
/// Every refusal is a settings::Error that names file, line and key, says what would be right, and suggests a key for a misspelt one:
///     config/plant.toml:12: wheel.inertia_kgm2: 900 is out of range 0.01 to 100
///     config/plant.toml:14: wheel.mass_lb: unit: expected mass_kg, got mass_lb
///     config/plant.toml:9: wheeel: unknown table; did you mean 'wheel'?
///
/// Units stand in key names (`_kg`, `_mps`, `_ms`), so a value in another unit is an unknown key, never silently misread. A Table shares ownership of
/// its document. Asking for a key marks it as known, even through a const object: use a document from one thread only.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/host/settings/error.hpp"

namespace settings {

/// Both ends are allowed values.
struct Range {
    double min = -std::numeric_limits<double>::infinity();
    double max = std::numeric_limits<double>::infinity();
};

/// Both ends are allowed values.
struct IntegerRange {
    std::int64_t min = std::numeric_limits<std::int64_t>::min();
    std::int64_t max = std::numeric_limits<std::int64_t>::max();
};

/// Both ends are allowed counts.
struct Count {
    std::size_t min = 1;
    std::size_t max = std::numeric_limits<std::size_t>::max();
};

struct NumbersRule {
    Range range{};
    Count count{};
    bool strictly_increasing = false;
};

/// One allowed word of a choice and what it means.
template <typename T>
struct Choice {
    std::string_view name;
    T value;
};

/// One table of a document. Every reader throws Error if the key is missing, of the wrong type or out of range. Its `find_` variant returns nullopt
/// for a missing key, and throws if the key is present but wrong.
class Table {
  public:
    /// A finite number; an integer is accepted, a boolean, a string, nan and inf are not.
    [[nodiscard]] double number(std::string_view key, const Range& range = {}) const;
    [[nodiscard]] std::optional<double> find_number(std::string_view key, const Range& range = {}) const {
        return has(key) ? std::optional(number(key, range)) : std::nullopt;
    }

    /// A TOML integer within `range` and within T; 60.0 is no integer.
    template <std::integral T = std::int64_t>
    [[nodiscard]] T integer(std::string_view key, const IntegerRange& range = {}) const {
        return static_cast<T>(integer_within(key, narrowed<T>(range)));
    }
    template <std::integral T = std::int64_t>
    [[nodiscard]] std::optional<T> find_integer(std::string_view key, const IntegerRange& range = {}) const {
        return has(key) ? std::optional(integer<T>(key, range)) : std::nullopt;
    }

    [[nodiscard]] bool boolean(std::string_view key) const;
    [[nodiscard]] std::optional<bool> find_boolean(std::string_view key) const { return has(key) ? std::optional(boolean(key)) : std::nullopt; }

    /// A string of at least one character.
    [[nodiscard]] std::string text(std::string_view key) const;
    [[nodiscard]] std::optional<std::string> find_text(std::string_view key) const { return has(key) ? std::optional(text(key)) : std::nullopt; }

    /// A string that is one of the names of `options`:
    ///     static constexpr std::array<settings::Choice<Law>, 2> kLaws{{{"wheel_slip", Law::wheel_slip},
    ///     ...}}; table.choice<Law>("law", kLaws);
    template <typename T>
    [[nodiscard]] T choice(std::string_view key, std::span<const Choice<T>> options) const {
        std::vector<std::string_view> names;
        for (const auto& option : options) names.push_back(option.name);
        return options[index_of_choice(key, names)].value;
    }
    template <typename T>
    [[nodiscard]] std::optional<T> find_choice(std::string_view key, std::span<const Choice<T>> options) const {
        return has(key) ? std::optional(choice<T>(key, options)) : std::nullopt;
    }

    /// An array of numbers, each as for number().
    [[nodiscard]] std::vector<double> numbers(std::string_view key, const NumbersRule& rule = {}) const;
    [[nodiscard]] std::optional<std::vector<double>> find_numbers(std::string_view key, const NumbersRule& rule = {}) const {
        return has(key) ? std::optional(numbers(key, rule)) : std::nullopt;
    }

    /// `[wheel]`, or `wheel = { ... }`.
    [[nodiscard]] Table table(std::string_view key) const;
    [[nodiscard]] std::optional<Table> find_table(std::string_view key) const { return has(key) ? std::optional(table(key)) : std::nullopt; }

    /// The tables under `key`, in file order: an array of tables (`[[signal]]`), or named ones
    /// (`[signal.speed]`, see name()). A missing key counts as no tables, so it is refused unless `count.min` is 0.
    [[nodiscard]] std::vector<Table> tables(std::string_view key, const Count& count = {}) const;
    /// The named tables of this table, in file order; every value in it must be a table.
    [[nodiscard]] std::vector<Table> tables(const Count& count = {}) const;

    /// Whether the key is present. Marks it as known, so that finish() accepts it.
    [[nodiscard]] bool has(std::string_view key) const;

    /// The last key of path(): "dry_asphalt" for `[surfaces.dry_asphalt]`, "signal[2]" in an array of tables,
    /// "" for the root.
    [[nodiscard]] const std::string& name() const;
    /// The keys from the root, "surfaces.dry_asphalt"; "" for the root.
    [[nodiscard]] const std::string& path() const;
    [[nodiscard]] const std::string& file() const;

    /// Throws Error with the caller's `message` at the line of `key` (of this table if there is no such key).
    [[noreturn]] void fail(std::string_view key, const std::string& message) const;

  private:
    friend class Document;
    struct Scope;
    explicit Table(std::shared_ptr<const Scope> scope) : scope_(std::move(scope)) {}

    template <std::integral T>
    [[nodiscard]] static constexpr IntegerRange narrowed(const IntegerRange& range) {
        using Limits = std::numeric_limits<T>;
        constexpr bool above = std::cmp_greater(Limits::max(), std::numeric_limits<std::int64_t>::max());
        constexpr std::int64_t max = above ? std::numeric_limits<std::int64_t>::max() : static_cast<std::int64_t>(Limits::max());
        return {std::max(range.min, static_cast<std::int64_t>(Limits::min())), std::min(range.max, max)};
    }
    [[nodiscard]] std::int64_t integer_within(std::string_view key, const IntegerRange& range) const;
    [[nodiscard]] std::size_t index_of_choice(std::string_view key, std::span<const std::string_view> names) const;

    std::shared_ptr<const Scope> scope_;
};

/// One TOML file (v1.0, UTF-8, with or without byte order mark).
class Document {
  public:
    /// Throws Error if the file is missing, unreadable or not a file, or at the line of the first syntax error or duplicate key.
    [[nodiscard]] static Document load(const std::filesystem::path& path);
    /// The same from memory; `name` replaces the file name in messages.
    [[nodiscard]] static Document parse(std::string text, std::string name);

    [[nodiscard]] Table root() const;
    /// The bytes that were parsed, for hash_bytes().
    [[nodiscard]] const std::string& bytes() const;

    /// Call after reading everything: throws Error at the first key that was not asked for.
    void finish() const;

  private:
    struct Content;
    friend struct Table::Scope;
    explicit Document(std::shared_ptr<Content> content) : content_(std::move(content)) {}

    std::shared_ptr<Content> content_;
};

}  // namespace settings
