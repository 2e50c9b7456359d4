#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace record_test {

/// The lines of a text file.
[[nodiscard]] inline std::vector<std::string> lines(const std::filesystem::path& path) {
    std::vector<std::string> all;
    std::ifstream in(path);
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
}

}  // namespace record_test
