/// Suggestions for misspelt words.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace settings {

/// The word of `known` that `word` most likely misspells, "" if none is close: differences in letter case, `-` for `_`, or about one edit (insertion,
/// deletion, substitution, swap of neighbours) per four characters. Words that differ only in a number (c1, c2) do not count as misspellings.
[[nodiscard]] std::string_view nearest(std::string_view word, std::span<const std::string_view> known);

/// Whether `expected` ends in a unit (`mass_kg`) and `got` is the same stem with another ending or none
/// (`mass_lb`, `mass`).
[[nodiscard]] bool differs_in_unit(std::string_view expected, std::string_view got);

/// `word` for a message: control bytes, which could disturb a terminal, are written as \xNN.
[[nodiscard]] std::string printable(std::string_view word);

}  // namespace settings
