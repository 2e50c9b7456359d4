/// Pictures by gnuplot, whole or not there.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace pictures {

/// As a string of gnuplot's language.
[[nodiscard]] std::string gnuplot_quoted(const std::string& text);

/// A block of rows for `plot $name`; one row of NaN where there are none, since gnuplot takes an empty block for an error.
[[nodiscard]] std::string gnuplot_block(std::string_view name, std::string_view rows);

/// Okabe and Ito's colours, which colour-blind readers tell apart, with a grey for their yellow, which does not show on white.
enum Colour : std::size_t { blue, vermillion, green, purple, orange, sky, black, grey };
[[nodiscard]] inline const char* gnuplot_colour(std::size_t i) {
    constexpr std::array<const char*, 8> kColours{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8a8a8a"};
    return kColours[i % kColours.size()];
}

/// Runs `commands`, with light grid and border, into `picture`, a PNG, and a .svg beside it, of `width` x `height` pixels; where `picture` is the
/// .svg the .png lies beside it. Their folder is made. Throws std::runtime_error when gnuplot is not installed or fails, with what it said.
void run_gnuplot(const std::filesystem::path& picture, int width, int height, const std::string& commands);

}  // namespace pictures
