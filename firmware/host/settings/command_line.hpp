/// Command-line options that all programs share.
///
///     settings::add_choice(app, "--clock", clock, {{"timer", Clock::timer}, {"sync", Clock::sync}}, "what a step waits for");
///     settings::existing_file(app.add_option("--dbc", dbc, "bus layout"));
///     if (const auto status = settings::parse(app, argc, argv)) return *status;
#pragma once

#include <CLI/CLI.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace settings {

/// Nothing if the program shall run. Otherwise the exit status: 0 after --help or --version; 2 after a usage error, reported on standard error with a
/// suggestion for a misspelt verb or option.
[[nodiscard]] std::optional<int> parse(CLI::App& app, int argc, const char* const* argv);

/// Accepts only these words, which --help lists; the error for another word suggests the nearest one. Checks each value of an option with several.
CLI::Option* one_of(CLI::Option* option, std::vector<std::string> words);

/// An option that takes the name of a value. The default is the present content of `value`.
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

/// The named file or directory must exist, otherwise exit status 2 with its name. Checks each value of an option with several.
CLI::Option* existing_file(CLI::Option* option);
CLI::Option* existing_directory(CLI::Option* option);
CLI::Option* existing_path(CLI::Option* option);
/// A file to be written or replaced. Its directory must exist, so that a misspelt one is not created; otherwise exit status 2 before any work is
/// done.
CLI::Option* result_file(CLI::Option* option);

/// `--config DIRECTORY`.
CLI::Option* add_config_directory(CLI::App& app, std::filesystem::path& directory);
/// `--out DIRECTORY`; the default is the present content of `directory`, if not empty.
CLI::Option* add_out(CLI::App& app, std::filesystem::path& directory, const std::string& what);
/// `--threads N`. Results do not depend on it.
CLI::Option* add_threads(CLI::App& app, unsigned& threads, const std::string& default_is = "all cores");
/// `--dbc FILE` and `--binding FILE`; empty if not given: the caller then uses those of the configuration directory.
void add_layout_files(CLI::App& app, std::filesystem::path& dbc, std::filesystem::path& binding);
/// `--json FILE`; pass `where` to deliver().
CLI::Option* add_json(CLI::App& app, std::string& where, const std::string& what);
/// `--picture FILE`; `what` it shows and which files come with it.
CLI::Option* add_picture(CLI::App& app, std::filesystem::path& file, const std::string& what,
                         const std::string& with_it = ", as SVG and data beside it, too");
/// `--no-pictures`, which sets `pictures` to false.
CLI::Option* add_no_pictures(CLI::App& app, bool& pictures);
/// `--seed N`; the default is the present `seed`.
CLI::Option* add_seed(CLI::App& app, std::uint64_t& seed, const std::string& what = "seed of every random draw");

/// Writes `text` atomically to the file `where`, to standard output for "-", nowhere for "". Throws Error if the file cannot be written.
void deliver(const std::string& where, std::string_view text);

}  // namespace settings
