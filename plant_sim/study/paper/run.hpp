/// Runs the commands of sections as programs of their own, several sections at a time, and keeps what they printed. A program, not a call:
/// what fails or stops takes no other section with it, and its printed table is the page's.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host/settings/config_directory.hpp"
#include "plant_sim/study/paper/sections.hpp"

namespace paper {

struct CommandResult {
    std::string line;    ///< as it was run
    int status = -1;     ///< of exit; 128 + signal; -1: not run, since one ahead of it failed
    std::string output;  ///< standard output
    std::string errors;  ///< standard error
};

struct SectionResult {
    const Section* section = nullptr;
    std::filesystem::path directory;
    std::vector<CommandResult> commands;

    /// Every command exited with 0.
    [[nodiscard]] bool answered_yes() const;
    /// A command exited with 2 or more, or not at all: there is no answer.
    [[nodiscard]] bool failed() const;
};

struct RunOptions {
    std::filesystem::path out;
    std::filesystem::path config = settings::config_directory();
    bool quick = false;
    unsigned jobs = 1;  ///< sections at a time
    /// Finds the program of a command by the command's first word; empty: there is none of that name.
    std::function<std::filesystem::path(const std::string& name)> program;
    /// After each section; never two calls at a time.
    std::function<void(const SectionResult&, std::size_t done, std::size_t all)> progress;
};

/// Results in the order of the contents. A section whose `after` failed is not run. Exit status 1 of a command is an answer and the section
/// goes on; 2 or more ends it. Directories of sections begin empty. Throws std::runtime_error where they cannot be made, or hold what no report
/// has made.
[[nodiscard]] std::vector<SectionResult> run_sections(const Contents& contents, const RunOptions& options);

}  // namespace paper
