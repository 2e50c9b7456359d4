#include "rig_bridge/bridge/abort_hook.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sched.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <thread>

namespace rig::bridge {

namespace {

std::string variable(const char* name, std::string value) {
    const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20U || c == '\x7f'; };
    std::replace_if(value.begin(), value.end(), is_control, ' ');
    return std::string(name) + "=" + value;
}

/// Resets in the child what it must not inherit from the bridge: real-time priority, blocked signals, standard input.
class Spawn {
  public:
    Spawn() {
        posix_spawn_file_actions_init(&files_);
        posix_spawn_file_actions_addopen(&files_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
        posix_spawnattr_init(&attributes_);
        sigset_t none{};
        sigset_t usual{};
        sigemptyset(&none);
        sigemptyset(&usual);
        sigaddset(&usual, SIGPIPE);
        posix_spawnattr_setsigmask(&attributes_, &none);
        posix_spawnattr_setsigdefault(&attributes_, &usual);
        posix_spawnattr_setpgroup(&attributes_, 0);
        const sched_param ordinary{};
        posix_spawnattr_setschedpolicy(&attributes_, SCHED_OTHER);
        posix_spawnattr_setschedparam(&attributes_, &ordinary);
        posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSCHEDULER);
    }
    ~Spawn() {
        posix_spawnattr_destroy(&attributes_);
        posix_spawn_file_actions_destroy(&files_);
    }
    Spawn(const Spawn&) = delete;
    Spawn& operator=(const Spawn&) = delete;

    /// 0, or an errno.
    int start(pid_t& child, const std::filesystem::path& program, std::vector<std::string> own) {
        std::string name = program.string();
        std::vector<char*> arguments{name.data(), nullptr};
        std::vector<char*> all;
        all.reserve(own.size() + 100);
        for (std::string& one : own) all.push_back(one.data());
        for (char** one = environ; *one != nullptr; ++one)
            if (std::strncmp(*one, "RIG_", 4) != 0) all.push_back(*one);
        all.push_back(nullptr);
        return posix_spawn(&child, name.c_str(), &files_, &attributes_, arguments.data(), all.data());
    }

  private:
    posix_spawn_file_actions_t files_{};
    posix_spawnattr_t attributes_{};
};

/// Whether the child has ended in that time.
bool ended(pid_t child, int& status, std::chrono::milliseconds limit) {
    constexpr std::chrono::milliseconds kLook{10};
    const auto until = std::chrono::steady_clock::now() + limit;
    for (;;) {
        if (waitpid(child, &status, WNOHANG) == child) return true;
        if (std::chrono::steady_clock::now() >= until) return false;
        std::this_thread::sleep_for(kLook);
    }
}

}  // namespace

std::vector<std::string> environment_of(const AbortReport& report) {
    return {variable("RIG_OUTCOME", report.outcome),
            variable("RIG_CAUSE", report.cause),
            variable("RIG_NEXT_STEP", report.next_step),
            variable("RIG_CAMPAIGN", report.campaign),
            variable("RIG_MANEUVER", std::to_string(report.maneuver)),
            variable("RIG_FOLDER", std::filesystem::absolute(report.folder).string())};
}

void check_hook(const std::filesystem::path& program) {
    if (!std::filesystem::is_regular_file(program) || access(program.c_str(), X_OK) != 0)
        throw std::invalid_argument("--on-abort " + program.string() +
                                    ": expected a program or script that may be run, without arguments (chmod +x)");
}

std::string run_hook(const std::filesystem::path& program, const std::vector<std::string>& environment, std::chrono::milliseconds limit) {
    pid_t child = 0;
    if (const int error = Spawn().start(child, std::filesystem::absolute(program), environment); error != 0)
        return fmt::format("{}: {}", program.string(), std::strerror(error));
    int status = 0;
    if (!ended(child, status, limit)) {
        kill(-child, SIGKILL);
        constexpr std::chrono::seconds kLast{1};
        (void)ended(child, status, kLast);
        return fmt::format("{}: had not ended after {:.1f} s and was killed", program.string(), std::chrono::duration<double>(limit).count());
    }
    if (WIFSIGNALED(status)) return fmt::format("{}: ended by signal {}", program.string(), WTERMSIG(status));
    if (WEXITSTATUS(status) != 0) return fmt::format("{}: exit status {}", program.string(), WEXITSTATUS(status));
    return {};
}

}  // namespace rig::bridge
