/// The table of docs/user/faults.md.
#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace fault_table {

struct Row {
    int bit = -1;
    std::string fault, where;
    int periods = 0;
};

inline std::string trimmed(const std::string& text) {
    const auto first = text.find_first_not_of(' ');
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

/// The table of docs/user/faults.md.
inline std::vector<Row> documented() {
    std::ifstream file("docs/user/faults.md");
    std::vector<Row> rows;
    for (std::string line; std::getline(file, line);) {
        std::vector<std::string> cells;
        std::istringstream cut(line);
        for (std::string cell; std::getline(cut, cell, '|');) cells.push_back(trimmed(cell));
        if (cells.size() != 7 || cells[1].empty() || cells[1].find_first_not_of("0123456789") != std::string::npos) continue;
        rows.push_back({std::stoi(cells[1]), cells[2], cells[4], std::stoi(cells[5])});
    }
    return rows;
}

}  // namespace fault_table
