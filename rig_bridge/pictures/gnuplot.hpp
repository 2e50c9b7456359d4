/// Pictures by gnuplot, whole or not there.
#pragma once

#include <filesystem>
#include <string>

namespace study {

/// As a string of gnuplot's language.
[[nodiscard]] std::string gnuplot_quoted(const std::string& text);

/// Runs `commands` with the output set to `png`, as a picture of `width` x `height` pixels. Throws std::runtime_error when gnuplot is
/// not installed or fails, with what it said.
void run_gnuplot(const std::filesystem::path& png, int width, int height, const std::string& commands);

}  // namespace study
