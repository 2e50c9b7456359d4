#include "firmware/host/settings/near_miss.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace settings {

namespace {

constexpr bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// ASCII lower case, with `_` for `-`.
std::string folded(std::string_view word) {
    std::string result(word);
    for (char& c : result) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
        if (c == '-') c = '_';
    }
    return result;
}

bool differ_only_in_digits(std::string a, std::string b) {
    if (a == b) return false;
    std::erase_if(a, is_digit);
    std::erase_if(b, is_digit);
    return a == b;
}

/// Insertions, deletions, substitutions and swaps of neighbours (optimal string alignment distance).
std::size_t edits_between(const std::string& a, const std::string& b) {
    const std::size_t width = b.size() + 1;
    std::vector<std::size_t> edits((a.size() + 1) * width);
    const auto at = [&](std::size_t i, std::size_t j) -> std::size_t& { return edits[i * width + j]; };
    for (std::size_t i = 0; i <= a.size(); ++i) {
        for (std::size_t j = 0; j <= b.size(); ++j) {
            if (i == 0 || j == 0) {
                at(i, j) = i + j;
                continue;
            }
            const std::size_t substitution = at(i - 1, j - 1) + (a[i - 1] == b[j - 1] ? 0 : 1);
            at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1, substitution});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
        }
    }
    return edits.back();
}

/// Units at the end of key names: those used in our files and others that users may write.
bool is_unit(std::string_view word) {
    static constexpr std::array<std::string_view, 77> kUnits{
        "s",   "ms",  "us",  "ns",  "min",  "h",    "Hz",    "kHz", "MHz", "m",   "mm",    "cm",     "km",   "um",  "in",  "ft",
        "m2",  "mm2", "cm2", "in2", "m3",   "mm3",  "cm3",   "kg",  "g",   "t",   "lb",    "lbs",    "slug", "N",   "kN",  "daN",
        "lbf", "kgf", "Nm",  "kNm", "ftlb", "Pa",   "kPa",   "MPa", "hPa", "bar", "mbar",  "psi",    "A",    "mA",  "uA",  "V",
        "mV",  "W",   "kW",  "hp",  "J",    "kJ",   "MJ",    "rad", "deg", "rev", "radps", "degps",  "rpm",  "rps", "mps", "kmh",
        "kph", "kt",  "kts", "mph", "mps2", "kgm2", "kgpm3", "Npm", "pct", "K",   "Paps",  "radps2", "mps3"};
    return std::find(kUnits.begin(), kUnits.end(), word) != kUnits.end();
}

}  // namespace

std::string_view nearest(std::string_view word, std::span<const std::string_view> known) {
    constexpr std::size_t kLongestWord = 64;
    constexpr std::size_t kLettersPerEdit = 4;
    if (word.size() > kLongestWord) return {};
    const auto slip = folded(word);
    std::size_t fewest = slip.size() / kLettersPerEdit + 1;
    std::string_view found;
    for (const auto candidate : known) {
        const auto [shorter, longer] = std::minmax({word.size(), candidate.size()});
        // An edit changes the length by one at most.
        if (shorter == 0 || longer > kLongestWord || longer - shorter >= fewest) continue;
        const auto meant = folded(candidate);
        if (differ_only_in_digits(slip, meant)) continue;
        const auto edits = edits_between(slip, meant);
        if (edits < fewest) {
            fewest = edits;
            found = candidate;
        }
    }
    return found;
}

bool differs_in_unit(std::string_view expected, std::string_view got) {
    const auto end_of_stem = expected.rfind('_');
    if (end_of_stem == std::string_view::npos || !is_unit(expected.substr(end_of_stem + 1))) return false;
    const auto stem = expected.substr(0, end_of_stem);
    if (got == stem) return true;
    return got != expected && got.starts_with(stem) && got.size() > stem.size() + 1 && got[stem.size()] == '_' &&
           is_unit(got.substr(stem.size() + 1));
}

std::string printable(std::string_view word) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string result;
    const auto escape = [&](unsigned char byte) {
        result += "\\x";
        result += kDigits[byte >> 4U];
        result += kDigits[byte & 0xFU];
    };
    for (std::size_t i = 0; i < word.size(); ++i) {
        const auto byte = static_cast<unsigned char>(word[i]);
        const auto next = i + 1 < word.size() ? static_cast<unsigned char>(word[i + 1]) : 0U;
        if (byte < 0x20U || byte == 0x7FU) {
            escape(byte);
        } else if (byte == 0xC2U && next >= 0x80U && next < 0xA0U) {  // UTF-8 of the control characters U+0080 to U+009F
            escape(byte);
            escape(static_cast<unsigned char>(next));
            ++i;
        } else {
            result += word[i];
        }
    }
    return result;
}

}  // namespace settings
