#include "plant_sim/bench/child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>

namespace antiskid::bench {

namespace {

constexpr std::chrono::seconds kEndTimeout{30};

}  // namespace

Child::Child(const std::vector<std::string>& words, const std::filesystem::path& log) : program_(words.at(0)), log_(log) {
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, 1, log_.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0666);
    posix_spawn_file_actions_adddup2(&files, 1, 2);
    const int error = posix_spawnp(&pid_, arguments[0], &files, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0) throw std::system_error(error, std::generic_category(), words[0]);
    // Not by pidfd_open(): its header in glibc 2.36 gives it C++ linkage.
    descriptor_ = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
    if (descriptor_ >= 0) return;
    const int reason = errno;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    throw std::system_error(reason, std::generic_category(), "pidfd_open");
}

Child::~Child() {
    if (!ended_) {
        kill(pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }
    close(descriptor_);
}

bool Child::ends_within(const std::chrono::milliseconds time) {
    if (ended_) return true;
    pollfd end{.fd = descriptor_, .events = POLLIN, .revents = 0};
    if (poll(&end, 1, static_cast<int>(time.count())) <= 0) return false;
    int raw = 0;
    waitpid(pid_, &raw, 0);
    ended_ = true;
    status_ = WIFSIGNALED(raw) ? 128 + WTERMSIG(raw) : WEXITSTATUS(raw);
    return true;
}

void Child::stop() {
    if (!ended_) kill(pid_, SIGTERM);
    if (!ends_within(kEndTimeout))
        throw std::runtime_error(name() + " did not end within " + std::to_string(kEndTimeout.count()) + " s of SIGTERM; see " + log_.string());
}

void Child::expect_success() const {
    if (status_ != 0) throw std::runtime_error(name() + " ended with status " + std::to_string(status_) + "; see " + log_.string());
}

}  // namespace antiskid::bench
