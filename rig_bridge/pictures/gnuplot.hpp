/// Draws pictures with gnuplot; files are written atomically.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace pictures {

/// Quotes `text` as a gnuplot string.
[[nodiscard]] std::string gnuplot_quoted(const std::string& text);

/// A data block for `plot $name`; without rows a single row of NaN, because gnuplot rejects an empty block.
[[nodiscard]] std::string gnuplot_block(std::string_view name, std::string_view rows);

/// Okabe and Ito's colours, which colour-blind readers tell apart, with a grey for their yellow, which does not show on white.
enum Colour : std::size_t { blue, vermillion, green, purple, orange, sky, black, grey };
[[nodiscard]] inline const char* gnuplot_colour(std::size_t i) {
    constexpr std::array<const char*, 8> kColours{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8a8a8a"};
    return kColours[i % kColours.size()];
}

/// Runs `commands`, with light grid and border, into `picture`, a PNG, and a .svg beside it, of `width` x `height` pixels; if `picture` is the .svg,
/// the .png is written beside it. Creates their folder. Throws std::runtime_error if gnuplot is not installed, or fails, with its message.
void run_gnuplot(const std::filesystem::path& picture, int width, int height, const std::string& commands);

}  // namespace pictures
