#include "firmware/host/settings/command_line.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/near_miss.hpp"

namespace settings {

namespace {

namespace fs = std::filesystem;

std::string suggestion(std::string_view word, const std::vector<std::string>& known) {
    const std::vector<std::string_view> views(known.begin(), known.end());
    const std::string_view near = nearest(word, views);
    return near.empty() ? std::string() : "; did you mean '" + std::string(near) + "'?";
}

/// `rig-lab wear fit`: the verb that was reached, as it was typed.
std::string full_name(const CLI::App& app) {
    return app.get_parent() == nullptr ? app.get_name() : full_name(*app.get_parent()) + " " + app.get_name();
}

const CLI::App& innermost(const CLI::App& app) {
    const std::vector<CLI::App*> verbs = app.get_subcommands();
    return verbs.empty() ? app : innermost(*verbs.back());
}

/// The first word that nothing on the command line takes, with what may have been meant; "" where there is none.
std::string unknown_word(const CLI::App& app) {
    const std::vector<std::string> words = app.remaining();
    if (words.empty()) {
        const std::vector<CLI::App*> verbs = app.get_subcommands();
        return verbs.empty() ? std::string() : unknown_word(*verbs.back());
    }
    const std::string word = words.front().substr(0, words.front().find('='));
    std::vector<std::string> known;
    if (word.starts_with('-')) {
        for (const CLI::Option* const option : app.get_options())
            for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
        return "there is no option '" + printable(word) + "'" + suggestion(word, known);
    }
    const std::vector<const CLI::App*> verbs = app.get_subcommands([](const CLI::App*) { return true; });
    for (const CLI::App* const verb : verbs) known.push_back(verb->get_name());
    const bool is_verb = !verbs.empty() && app.get_subcommands().empty();
    return (is_verb ? "there is no '" : "nothing takes '") + printable(words.front()) + "'" + suggestion(word, known);
}

/// The first number given that is none, which every CLI::Range lets pass; "" where there is none.
std::string not_finite(const CLI::App& app) {
    for (const CLI::Option* const option : app.get_options()) {
        if (!option->get_type_name().starts_with("FLOAT")) continue;
        for (const std::string& text : option->results())
            if (double value = 0.0; CLI::detail::lexical_cast(text, value) && !std::isfinite(value))
                return option->get_name() + ": '" + printable(text) + "': expected a finite number";
    }
    const std::vector<CLI::App*> verbs = app.get_subcommands();
    return verbs.empty() ? std::string() : not_finite(*verbs.back());
}

CLI::Option* checked(CLI::Option* option, const char* type, bool (*good)(const fs::path&), const char* why) {
    const auto check = [good, why](const std::string& text) {
        std::error_code none;
        if (good(text)) return std::string();
        return printable(text) + ": " + (fs::exists(text, none) ? why : "there is no such file or directory");
    };
    return option->check(CLI::Validator(check, ""))->type_name(type);
}

bool is_there(const fs::path& path) {
    std::error_code none;
    return fs::exists(path, none);
}
bool is_folder(const fs::path& path) {
    std::error_code none;
    return fs::is_directory(path, none);
}
bool is_file(const fs::path& path) {
    return is_there(path) && !is_folder(path);
}

int refused(const CLI::App& app, const std::string& mistake) {
    const std::string name = full_name(innermost(app));
    (void)std::fprintf(stderr, "%s: %s\nSee %s --help.\n", name.c_str(), mistake.c_str(), name.c_str());
    return 2;
}

}  // namespace

std::optional<int> parse(CLI::App& app, int argc, const char* const* argv) {
    try {
        app.parse(argc, argv);
        const std::string mistake = not_finite(app);
        if (mistake.empty()) return std::nullopt;
        return refused(app, mistake);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);
        const std::string unknown = unknown_word(app);
        return refused(app, unknown.empty() ? error.what() : unknown);
    }
}

CLI::Option* one_of(CLI::Option* option, std::vector<std::string> words) {
    std::string list;
    for (const std::string& word : words) list += (list.empty() ? "" : ",") + word;
    const auto check = [words = std::move(words), list](const std::string& text) {
        if (std::find(words.begin(), words.end(), text) != words.end()) return std::string();
        return "'" + printable(text) + "' is none of " + list + suggestion(text, words);
    };
    return option->check(CLI::Validator(check, ""))->type_name("{" + list + "}");
}

CLI::Option* existing_file(CLI::Option* option) {
    return checked(option, "FILE", is_file, "is a directory, not a file");
}

CLI::Option* existing_directory(CLI::Option* option) {
    return checked(option, "DIRECTORY", is_folder, "is no directory");
}

CLI::Option* existing_path(CLI::Option* option) {
    return checked(option, "PATH", is_there, "");
}

CLI::Option* result_file(CLI::Option* option) {
    const auto check = [](const std::string& text) {
        const fs::path folder = fs::path(text).parent_path();
        if (folder.empty() || is_folder(folder)) return std::string();
        return printable(text) + ": there is no directory " + printable(folder.string()) + "; make it first";
    };
    return option->check(CLI::Validator(check, ""))->type_name("FILE");
}

CLI::Option* add_config_directory(CLI::App& app, fs::path& directory) {
    return existing_directory(app.add_option("--config", directory, "configuration files"))->capture_default_str();
}

void add_layout_files(CLI::App& app, fs::path& dbc, fs::path& binding) {
    existing_file(app.add_option("--dbc", dbc, "bus layout (default: CONFIG/antiskid.dbc)"));
    existing_file(app.add_option("--binding", binding, "binding of the layout (default: CONFIG/antiskid_binding.toml)"));
}

CLI::Option* add_out(CLI::App& app, std::filesystem::path& directory, const std::string& what) {
    CLI::Option* const option = app.add_option("--out", directory, what)->type_name("DIRECTORY");
    return directory.empty() ? option : option->capture_default_str();
}

CLI::Option* add_threads(CLI::App& app, unsigned& threads, const std::string& default_is) {
    constexpr unsigned kMax = 1024;
    return app.add_option("--threads", threads, "results do not depend on it (default: " + default_is + ")")->check(CLI::Range(1U, kMax));
}

CLI::Option* add_json(CLI::App& app, std::string& where, const std::string& what) {
    return result_file(app.add_option("--json", where, what + " as JSON; - for standard output instead of the table"));
}

CLI::Option* add_picture(CLI::App& app, fs::path& file, const std::string& what, const std::string& with_it) {
    return result_file(app.add_option("--picture", file, what + " (PNG)" + with_it));
}

CLI::Option* add_no_pictures(CLI::App& app, bool& pictures) {
    return app.add_flag("!--no-pictures", pictures, "without gnuplot");
}

CLI::Option* add_seed(CLI::App& app, std::uint64_t& seed, const std::string& what) {
    return app.add_option("--seed", seed, what)->capture_default_str();
}

void deliver(const std::string& where, std::string_view text) {
    if (where == "-") {
        if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
            throw Error("standard output", 0, "", "cannot be written");
    } else if (!where.empty()) {
        write_file(where, text);
    }
}

}  // namespace settings
