/// Pictures by gnuplot, whole or not there.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

namespace pictures {

/// As a string of gnuplot's language.
[[nodiscard]] std::string gnuplot_quoted(const std::string& text);

/// A block of rows for `plot $name`; one row of NaN where there are none, since gnuplot takes an empty block for an error.
[[nodiscard]] std::string gnuplot_block(std::string_view name, std::string_view rows);

/// Of lines and points beside each other.
[[nodiscard]] inline const char* gnuplot_colour(std::size_t i) {
    constexpr std::array<const char*, 15> kColours{"#1f4e79", "#c55a11", "#548235", "#7f3f98", "#bf9000", "#00808a", "#a61c3c", "#5b5b5b",
                                                   "#2e86de", "#e58e26", "#78a22f", "#b56bd0", "#806000", "#33b5c1", "#e0647f"};
    return kColours[i % kColours.size()];
}

/// Runs `commands`, with light grid and border, with the output set to `png`, as a picture of `width` x `height` pixels. Throws std::runtime_error
/// when gnuplot is not installed or fails, with what it said.
void run_gnuplot(const std::filesystem::path& png, int width, int height, const std::string& commands);

}  // namespace pictures
