/// What a report consists of: sections of commands, the pictures and tables that these leave, and the paper's numbers to hold them
/// against. config/report.toml is the one of the paper; a user may write his own.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace paper {

struct Picture {
    std::string file;  ///< SVG in the section's directory
    std::string caption;
    std::size_t command = 0;  ///< index of the one that makes it
};

/// One row of the comparison with the paper.
struct Comparison {
    std::string quantity;
    std::string unit;               ///< empty: none
    std::string source;             ///< where the paper has it
    std::string relation;           ///< ahead of the paper's number, e.g. "at least"; empty: it is that number
    std::optional<double> printed;  ///< the paper's; none: it keeps it to itself
    std::string file;               ///< JSON in the section's directory, or TOML; {config}/ ahead: of the configuration
    std::string at;                 ///< where in it, see value_at()
    int decimals = 3;
};

struct Section {
    std::string id;  ///< name of its directory: letters, digits, _ and -
    std::string title;
    std::string text;                         ///< paragraphs, empty lines between
    std::string html;                         ///< as it is, below the text; its <svg> is kept beside the page, too
    std::string after;                        ///< id of the section whose results it uses; empty: none
    std::vector<std::string> commands;        ///< with {here}, {out} and {config} for paths
    std::vector<std::string> quick_commands;  ///< of the fast form; empty: the same
    std::vector<std::size_t> shown;           ///< indices of the commands whose printed tables are in the page
    std::vector<Picture> pictures;
    std::vector<Comparison> comparisons;
};

struct Contents {
    std::string title;
    std::string text;
    std::vector<Section> sections;
};

/// Throws settings::Error naming file, line and key: also for an id that is there twice, an `after` that is no earlier section, and a
/// command that is not there.
[[nodiscard]] Contents load_contents(const std::filesystem::path& file);

}  // namespace paper
