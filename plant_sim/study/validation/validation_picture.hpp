/// The picture of Fig. 5: speeds, slip and speed errors over time, recorded and simulated.
#pragma once

#include <filesystem>
#include <string>

namespace validation {

/// Draws `csv` (Validation's to_csv) into `png`. Throws std::runtime_error when gnuplot is missing or fails.
void draw_validation(const std::filesystem::path& csv, const std::filesystem::path& png, const std::string& title);

}  // namespace validation
