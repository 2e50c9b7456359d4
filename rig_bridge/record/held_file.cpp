#include "rig_bridge/record/held_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <string_view>
#include <system_error>
#include <thread>

namespace rig::record {

namespace {

/// Others must be able to take it after us, whoever they are. In a sticky folder the kernel refuses O_CREAT on somebody else's file
/// (fs.protected_regular), so that is asked for only where there is none.
int open_or_make(const std::string& path) {
    constexpr int kHow = O_RDWR | O_CLOEXEC | O_NOFOLLOW;
    constexpr mode_t kEverybody = 0666;
    int file = ::open(path.c_str(), kHow);
    if (file >= 0 || errno != ENOENT) return file;
    file = ::open(path.c_str(), kHow | O_CREAT | O_EXCL, kEverybody);
    if (file < 0) return errno == EEXIST ? ::open(path.c_str(), kHow) : file;
    static_cast<void>(::fchmod(file, kEverybody));  // whatever the umask
    return file;
}

/// held_by() has it for an instant, too.
bool locks(int file) {
    constexpr int kTries = 5;
    constexpr std::chrono::milliseconds kBetween{20};
    for (int i = 0; i < kTries; ++i) {
        if (flock(file, LOCK_EX | LOCK_NB) == 0) return true;
        std::this_thread::sleep_for(kBetween);
    }
    return false;
}

HeldBy read_holder(int file) {
    std::array<char, 512> text{};
    const ssize_t size = pread(file, text.data(), text.size(), 0);
    const std::string_view all(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
    return {std::string(all.substr(0, all.find('\n')))};
}

}  // namespace

std::variant<std::unique_ptr<HeldFile>, HeldBy> hold(const std::filesystem::path& path, const std::string& who) {
    const int file = open_or_make(path.string());
    if (file < 0) throw std::system_error(errno, std::generic_category(), path.string());
    auto held = std::make_unique<HeldFile>(file);
    if (!locks(file)) return read_holder(file);
    const std::string line = who + "\n";
    // Only for the words of whoever comes second.
    static_cast<void>(ftruncate(file, 0) == 0 && pwrite(file, line.data(), line.size(), 0) > 0);
    return held;
}

std::optional<HeldBy> held_by(const std::filesystem::path& path) {
    const settings::FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
    if (!file.is_open() || flock(file.get(), LOCK_SH | LOCK_NB) == 0 || errno != EWOULDBLOCK) return std::nullopt;
    return read_holder(file.get());
}

}  // namespace rig::record
