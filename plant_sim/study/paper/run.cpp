#include "plant_sim/study/paper/run.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <fstream>
#include <iterator>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace paper {

namespace {

namespace fs = std::filesystem;

constexpr int kNotFound = 127;  // as in a shell

void replace_all(std::string& text, const std::string& what, const std::string& by) {
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size())) text.replace(at, what.size(), by);
}

/// Fills in the places of each word, so that a path with spaces stays one word. `--config {config}` is left out if it is every program's default.
std::vector<std::string> words_of(const std::string& line, const fs::path& here, const RunOptions& options) {
    std::vector<std::string> words;
    std::istringstream in(line);
    for (std::string word; in >> word;) {
        if (word == "{config}" && options.config == settings::config_directory() && !words.empty() && words.back() == "--config") {
            words.pop_back();
            continue;
        }
        replace_all(word, "{here}", here.string());
        replace_all(word, "{out}", options.out.string());
        replace_all(word, "{config}", options.config.string());
        words.push_back(word);
    }
    return words;
}

std::string joined(const std::vector<std::string>& words) {
    std::string line;
    for (const std::string& word : words) {
        if (!line.empty()) line += ' ';
        const bool plain = word.find(' ') == std::string::npos;
        line += plain ? word : "'" + word + "'";
    }
    return line;
}

std::string contents_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

int spawned(const fs::path& program, std::vector<std::string> words, const fs::path& output, const fs::path& errors) {
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions{};
    posix_spawn_file_actions_init(&actions);
    constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
    constexpr mode_t kMode = 0644;
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output.c_str(), kFlags, kMode);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, errors.c_str(), kFlags, kMode);
    pid_t child = 0;
    const int error = posix_spawn(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) {
        std::ofstream(errors) << program.string() << ": " << std::strerror(error) << '\n';
        return kNotFound;
    }
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    constexpr int kSignalled = 128;
    return WIFEXITED(status) ? WEXITSTATUS(status) : kSignalled + WTERMSIG(status);
}

void run_section(SectionResult& result, const RunOptions& options) {
    const Section& section = *result.section;
    if (const std::size_t from = section.html.find("<svg"); from != std::string::npos)
        std::ofstream(result.directory / (section.id + ".svg")) << section.html.substr(from, section.html.find("</svg>", from) + 6 - from);
    const bool quick = options.quick && !section.quick_commands.empty();
    const std::vector<std::string>& lines = quick ? section.quick_commands : section.commands;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const std::vector<std::string> words = words_of(lines[i], result.directory, options);
        CommandResult& command = result.commands[i];
        command.line = joined(words);
        const std::string number = std::to_string(i + 1);
        const fs::path output = result.directory / ("command-" + number + ".txt");
        const fs::path errors = result.directory / ("command-" + number + "-errors.txt");
        const fs::path program = options.program(words.front());
        if (program.empty()) {
            command.status = kNotFound;
            command.errors = words.front() + ": no such program beside this one";
        } else {
            // Verbs write single files into directories that are there.
            for (const fs::path word : words)
                if (word.has_extension() && word.parent_path().string().starts_with(result.directory.string()))
                    fs::create_directories(word.parent_path());
            command.status = spawned(program, words, output, errors);
            command.output = contents_of(output);
            command.errors = contents_of(errors);
        }
        if (command.status > 1) return;
    }
}

/// Sections that wait for another one, for several threads.
class Queue {
  public:
    Queue(std::vector<SectionResult>& results, const RunOptions& options)
        : results_(results), options_(options), states_(results.size(), State::waiting) {}

    void work() {
        std::unique_lock lock(mutex_);
        for (;;) {
            const std::size_t next = ready();
            if (next < results_.size()) {
                states_[next] = State::running;
                lock.unlock();
                run_section(results_[next], options_);
                lock.lock();
                finish(next);
            } else if (std::none_of(states_.begin(), states_.end(), [](State s) { return s == State::waiting; })) {
                return;
            } else {
                changed_.wait(lock);
            }
        }
    }

  private:
    enum class State { waiting, running, done };

    void finish(std::size_t i) {
        states_[i] = State::done;
        ++done_;
        if (options_.progress) options_.progress(results_[i], done_, results_.size());
        changed_.notify_all();
    }

    /// Index of the first section that can run, or the number of sections if none can at present. Sections that never can are marked as done.
    std::size_t ready() {
        for (std::size_t i = 0; i < results_.size(); ++i) {
            if (states_[i] != State::waiting) continue;
            const std::string& after = results_[i].section->after;
            if (after.empty()) return i;
            const auto before = static_cast<std::size_t>(
                std::find_if(results_.begin(), results_.end(), [&](const SectionResult& r) { return r.section->id == after; }) - results_.begin());
            if (states_[before] != State::done) continue;
            if (!results_[before].failed()) return i;
            results_[i].commands.front().errors = "not run: the section '" + after + "' failed";
            finish(i);
        }
        return results_.size();
    }

    std::vector<SectionResult>& results_;
    const RunOptions& options_;
    std::vector<State> states_;
    std::size_t done_ = 0;
    std::mutex mutex_;
    std::condition_variable changed_;
};

/// Empties the directory: programs refuse to overwrite a recording, and old files must not be taken for results. Removes only files of a report.
void begin_afresh(const fs::path& directory) {
    const fs::path mark = directory / ".report";
    if (fs::exists(directory) && !fs::is_empty(directory) && !fs::exists(mark))
        throw std::runtime_error(directory.string() + " is no report's and would be written over: choose another --out");
    fs::remove_all(directory);
    fs::create_directories(directory);
    std::ofstream(mark) << "Made by rig-lab report, which removes this directory before it makes it again.\n";
}

}  // namespace

bool SectionResult::passed() const {
    return std::all_of(commands.begin(), commands.end(), [](const CommandResult& c) { return c.status == 0; });
}

bool SectionResult::failed() const {
    return std::any_of(commands.begin(), commands.end(), [](const CommandResult& c) { return c.status < 0 || c.status > 1; });
}

std::vector<SectionResult> run_sections(const Contents& contents, const RunOptions& options) {
    std::vector<SectionResult> results;
    results.reserve(contents.sections.size());
    for (const Section& section : contents.sections) {
        std::vector<CommandResult> commands(section.commands.size());
        for (std::size_t i = 0; i < commands.size(); ++i) commands[i].line = joined(words_of(section.commands[i], options.out / section.id, options));
        results.push_back({&section, options.out / section.id, std::move(commands)});
        begin_afresh(results.back().directory);
    }
    Queue queue(results, options);
    std::vector<std::jthread> threads;
    const unsigned jobs = std::max(1U, options.jobs);
    for (unsigned i = 1; i < jobs; ++i) threads.emplace_back([&queue] { queue.work(); });
    queue.work();
    threads.clear();
    return results;
}

}  // namespace paper
