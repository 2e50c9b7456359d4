/// Runs the commands of sections as separate programs, several sections at a time, and keeps their output. As separate programs they cannot affect
/// another section when they fail, and the page shows the output that a user gets.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "firmware/host/settings/config_directory.hpp"
#include "plant_sim/study/paper/sections.hpp"

namespace paper {

struct CommandResult {
    std::string line;    ///< as it was run
    int status = -1;     ///< exit status; 128 + signal; -1: not run, since an earlier one failed
    std::string output;  ///< standard output
    std::string errors;  ///< standard error
};

struct SectionResult {
    const Section* section = nullptr;
    std::filesystem::path directory;
    std::vector<CommandResult> commands;

    /// Whether every command exited with 0.
    [[nodiscard]] bool passed() const;
    /// Whether a command exited with 2 or more, or not normally: there is no answer.
    [[nodiscard]] bool failed() const;
};

struct RunOptions {
    std::filesystem::path out;
    std::filesystem::path config = settings::config_directory();
    bool quick = false;
    unsigned jobs = 1;  ///< number of sections run at a time
    /// Returns the path of a command's program by the command's first word; empty: there is none.
    std::function<std::filesystem::path(const std::string& name)> program;
    /// Called after each section; never two calls at a time.
    std::function<void(const SectionResult&, std::size_t done, std::size_t all)> progress;
};

/// Returns results in the order of the contents. A section whose `after` failed is not run. With exit status 1 of a command the section continues,
/// with 2 or more it ends. Directories of sections are emptied first. Throws std::runtime_error if they cannot be made, or contain other files than
/// those of a report.
[[nodiscard]] std::vector<SectionResult> run_sections(const Contents& contents, const RunOptions& options);

}  // namespace paper
