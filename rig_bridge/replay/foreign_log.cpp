#include "rig_bridge/replay/foreign_log.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include "rig_bridge/replay/foreign_log_script.hpp"

namespace rig::replay {

using settings::FileDescriptor;

namespace {

namespace fs = std::filesystem;

/// The interpreter of the Debian package python3-can.
constexpr const char* kPython = "/usr/bin/python3";
/// Exit statuses of foreign_log.py.
constexpr int kUnreadable = 3, kDamaged = 4;

struct Pipe {
    FileDescriptor read{-1}, write{-1};
};

Pipe make_pipe(const std::string& name) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error(name + ": no pipe to its reader: " + std::strerror(errno));
    return {FileDescriptor(ends[0]), FileDescriptor(ends[1])};
}

std::string word(LogFormat format) {
    return format == LogFormat::vector_asc ? "asc" : format == LogFormat::vector_blf ? "blf" : "trc";
}

/// Standard streams of the child, and what it must not inherit from a real-time player.
class SpawnSettings {
  public:
    SpawnSettings(int in, int out, int err) {
        ::posix_spawn_file_actions_init(&actions_);
        ::posix_spawn_file_actions_adddup2(&actions_, in, STDIN_FILENO);
        ::posix_spawn_file_actions_adddup2(&actions_, out, STDOUT_FILENO);
        ::posix_spawn_file_actions_adddup2(&actions_, err, STDERR_FILENO);
        ::posix_spawnattr_init(&attributes_);
        const sched_param ordinary{};
        sigset_t none;
        ::sigemptyset(&none);
        ::posix_spawnattr_setschedpolicy(&attributes_, SCHED_OTHER);
        ::posix_spawnattr_setschedparam(&attributes_, &ordinary);
        ::posix_spawnattr_setsigmask(&attributes_, &none);
        ::posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSCHEDULER | POSIX_SPAWN_SETSIGMASK);
    }
    SpawnSettings(const SpawnSettings&) = delete;
    SpawnSettings& operator=(const SpawnSettings&) = delete;
    ~SpawnSettings() {
        ::posix_spawn_file_actions_destroy(&actions_);
        ::posix_spawnattr_destroy(&attributes_);
    }
    [[nodiscard]] const posix_spawn_file_actions_t* actions() const { return &actions_; }
    [[nodiscard]] const posix_spawnattr_t* attributes() const { return &attributes_; }

  private:
    posix_spawn_file_actions_t actions_{};
    posix_spawnattr_t attributes_{};
};

std::string last_line(std::string text) {
    while (!text.empty() && text.back() == '\n') text.pop_back();
    const auto end = text.rfind('\n');
    return end == std::string::npos ? text : text.substr(end + 1);
}

}  // namespace

LogFormat log_format(const fs::path& file) {
    std::error_code error;
    if (!fs::is_regular_file(file, error)) return LogFormat::candump;
    std::array<char, 16> head{};
    gzFile_s* const in = ::gzopen(file.c_str(), "rb");
    if (in == nullptr) return LogFormat::candump;
    const int got = ::gzread(in, head.data(), head.size());
    ::gzclose_r(in);
    std::string text(head.data(), static_cast<std::size_t>(std::max(got, 0)));
    if (text.starts_with("LOGG")) return LogFormat::vector_blf;
    if (text.starts_with("MDF  ") || text.starts_with("UnFinMF")) return LogFormat::mdf;
    if (text.starts_with(";$FILEVERSION") || text.starts_with(";####")) return LogFormat::peak_trc;
    if (text.starts_with("date ") || text.starts_with("Date ")) return LogFormat::vector_asc;
    return LogFormat::candump;
}

void reject_mdf(const fs::path& file) {
    if (log_format(file) != LogFormat::mdf) return;
    const auto command = [&](const char* format, const char* more) {
        return fmt::format("python3 -c \"from asammdf import MDF; MDF('{}').export('{}', '{}'{})\"", file.string(), format,
                           fs::path(file).replace_extension(format).string(), more);
    };
    throw std::runtime_error(
        fmt::format("{}: is an MDF recording, which is not read here; asammdf (pip install asammdf) makes a log of its frames: {}, "
                    "or a table of its signals: {}",
                    file.string(), command("asc", ""), command("csv", ", single_time_base=True")));
}

ForeignLog::ForeignLog(const fs::path& file, LogFormat format) : name_(file.string()), file_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (!file_.is_open()) throw std::runtime_error(name_ + ": cannot be read: " + std::strerror(errno));
    size_ = static_cast<double>(fs::file_size(file));
    Pipe out = make_pipe(name_), err = make_pipe(name_);
    const SpawnSettings spawn(file_.get(), out.write.get(), err.write.get());
    // -P: files beside the log are not imported as modules.
    std::array<std::string, 5> words{kPython, "-P", "-c", kForeignLogScript, word(format)};
    std::array<char*, 6> arguments{};
    std::transform(words.begin(), words.end(), arguments.begin(), [](std::string& text) { return text.data(); });
    const int error = ::posix_spawn(&process_, kPython, spawn.actions(), spawn.attributes(), arguments.data(), ::environ);
    if (error != 0)
        throw std::runtime_error(fmt::format("{}: logs of Vector and PEAK are read by python-can: apt install python3-can ({}: {})", name_, kPython,
                                             std::strerror(error)));
    lines_ = std::move(out.read);
    said_ = std::move(err.read);
}

ForeignLog::~ForeignLog() {
    if (process_ < 0) return;
    ::kill(process_, SIGTERM);
    ::waitpid(process_, nullptr, 0);
}

double ForeignLog::share() const {
    // The process reads through the same open file.
    const auto at = static_cast<double>(::lseek(file_.get(), 0, SEEK_CUR));
    return size_ > 0.0 ? std::clamp(at / size_, 0.0, 1.0) : 1.0;
}

ForeignLog::End ForeignLog::finish() {
    std::string text;
    std::array<char, 4096> block{};
    for (ssize_t got = 0; (got = ::read(said_.get(), block.data(), block.size())) > 0 || (got < 0 && errno == EINTR);)
        if (got > 0) text.append(block.data(), static_cast<std::size_t>(got));
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    text = last_line(text);
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    if (code == 0 || code == kDamaged) return {code == kDamaged, text};
    if (code == kUnreadable) throw std::runtime_error(name_ + ": " + text);
    throw std::runtime_error(fmt::format("{}: its reader, python3-can, failed: {}", name_, text.empty() ? "it was killed" : text));
}

}  // namespace rig::replay
