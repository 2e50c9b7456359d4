/// Contents of a report: sections of commands, the pictures and tables that these make, and the paper's numbers for comparison. config/report.toml is
/// the report on the paper; users may write their own.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace paper {

struct Picture {
    std::string file;  ///< SVG in the section's directory
    std::string caption;
    std::size_t command = 0;  ///< index of the command that makes it
};

/// One row of the comparison with the paper.
struct Comparison {
    std::string quantity;
    std::string unit;               ///< empty: none
    std::string source;             ///< place in the paper
    std::string relation;           ///< put before the paper's number, e.g. "at least"; empty: none
    std::optional<double> printed;  ///< the paper's number; none: it gives none
    std::string file;               ///< JSON in the section's directory, or TOML; with the prefix {config}/ in the configuration
    std::string at;                 ///< path of the value in it, see value_at()
    int decimals = 3;
};

struct Section {
    std::string id;  ///< name of its directory: letters, digits, _ and -
    std::string title;
    std::string text;                         ///< paragraphs, separated by empty lines
    std::string html;                         ///< inserted unchanged below the text; its <svg> is also kept beside the page
    std::string after;                        ///< id of the section whose results it uses; empty: none
    std::vector<std::string> commands;        ///< with {here}, {out} and {config} for paths
    std::vector<std::string> quick_commands;  ///< of the quick form; empty: the same
    std::vector<std::size_t> shown;           ///< indices of the commands whose output is in the page
    std::vector<Picture> pictures;
    std::vector<Comparison> comparisons;
};

struct Contents {
    std::string title;
    std::string text;
    std::vector<Section> sections;
};

/// Throws settings::Error naming file, line and key, also for a repeated id, an `after` that is not an earlier section, and an unknown command.
[[nodiscard]] Contents load_contents(const std::filesystem::path& file);

}  // namespace paper
