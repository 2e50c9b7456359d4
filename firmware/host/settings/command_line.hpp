/// What the command lines of all programs have alike.
///
///     settings::add_choice(app, "--clock", clock, {{"timer", Clock::timer}, {"sync", Clock::sync}}, "what a step waits for");
///     settings::existing_file(app.add_option("--dbc", dbc, "bus layout"));
///     if (const auto status = settings::parse(app, argc, argv)) return *status;
#pragma once

#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace settings {

/// Nothing when there is something to run. Else the exit status: 0 after --help or --version; 2 after a mistake, which standard error then names
/// with the word that a misspelt verb or option may have meant.
[[nodiscard]] std::optional<int> parse(CLI::App& app, int argc, const char* const* argv);

/// Only these words, which --help shows; a refusal says which one may have been meant. Of an option with several values, each of them.
CLI::Option* one_of(CLI::Option* option, std::vector<std::string> words);

/// A value by its name. What `value` holds is the default.
template <typename T>
CLI::Option* add_choice(CLI::App& app, const std::string& name, T& value, const std::vector<std::pair<std::string, T>>& choices,
                        const std::string& description) {
    std::vector<std::string> words;
    words.reserve(choices.size());
    for (const auto& choice : choices) words.push_back(choice.first);
    CLI::Option* const option = app.add_option_function<std::string>(
        name,
        [&value, choices](const std::string& word) {
            for (const auto& choice : choices)
                if (choice.first == word) value = choice.second;
        },
        description);
    for (const auto& choice : choices)
        if (choice.second == value) option->default_str(choice.first);
    return one_of(option, std::move(words));
}

/// What is named has to be there: status 2 and its name where it is not. Of an option with several values, each of them.
CLI::Option* existing_file(CLI::Option* option);
CLI::Option* existing_directory(CLI::Option* option);
CLI::Option* existing_path(CLI::Option* option);
/// A file that is written, or replaced: its directory has to be there, so that a misspelt one is not made; status 2 before any work where it is not.
CLI::Option* result_file(CLI::Option* option);

/// `--config DIRECTORY`.
CLI::Option* add_config_directory(CLI::App& app, std::filesystem::path& directory);
/// `--out DIRECTORY`; what `directory` holds, if anything, is the default.
CLI::Option* add_out(CLI::App& app, std::filesystem::path& directory, const std::string& what);
/// `--threads N`, on which no result depends.
CLI::Option* add_threads(CLI::App& app, unsigned& threads, const std::string& default_is = "all cores");
/// `--dbc FILE` and `--binding FILE`; empty where not given, and then those of the configuration directory.
void add_layout_files(CLI::App& app, std::filesystem::path& dbc, std::filesystem::path& binding);
/// `--json FILE`, for deliver().
CLI::Option* add_json(CLI::App& app, std::string& where, const std::string& what);

/// Writes `text` to the file `where`, whole or not at all; to standard output for "-"; nowhere for "". Throws Error where it cannot.
void deliver(const std::string& where, std::string_view text);

}  // namespace settings
