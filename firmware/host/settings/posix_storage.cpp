#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <system_error>
#include <thread>

#include "firmware/host/settings/file_descriptor.hpp"
#include "firmware/host/settings/storage.hpp"

namespace settings {

namespace fs = std::filesystem;

namespace {

int error_of(int result) {
    return result == 0 ? 0 : errno;
}

class PosixFile final : public File {
  public:
    explicit PosixFile(int descriptor) : file_(descriptor) {}

    std::int64_t read(std::span<char> bytes) override {
        return counted([&] { return ::read(file_.get(), bytes.data(), bytes.size()); });
    }
    std::int64_t append(std::string_view bytes) override {
        return counted([&] { return ::write(file_.get(), bytes.data(), bytes.size()); });
    }
    int truncate(std::int64_t size) override { return error_of(::ftruncate(file_.get(), size)); }
    int sync() override { return error_of(::fsync(file_.get())); }
    int close() override { return file_.close() ? 0 : errno; }

  private:
    template <typename Call>
    static std::int64_t counted(Call call) {
        for (;;) {
            const ssize_t count = call();
            if (count >= 0) return count;
            if (errno != EINTR) return -errno;
        }
    }
    FileDescriptor file_;
};

OpenResult opened(int descriptor) {
    if (descriptor < 0) return {.file = nullptr, .error = errno};
    return {.file = std::make_unique<PosixFile>(descriptor)};
}

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

LockHolder read_holder(int file) {
    std::array<char, 512> text{};
    const ssize_t size = pread(file, text.data(), text.size(), 0);
    const std::string_view all(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
    return {std::string(all.substr(0, all.find('\n')))};
}

}  // namespace

OpenResult PosixStorage::open(const fs::path& path) const {
    return opened(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
}

OpenResult PosixStorage::create(const fs::path& path) const {
    return opened(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
}

int PosixStorage::make_directory(const fs::path& path) const {
    return error_of(::mkdir(path.c_str(), 0777));
}

int PosixStorage::sync_directory(const fs::path& path) const {
    const FileDescriptor directory(::open(path.empty() ? "." : path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!directory.is_open()) return errno;
    const int error = error_of(::fsync(directory.get()));
    return error == EINVAL ? 0 : error;  // a file system that has no notion of it
}

int PosixStorage::rename(const fs::path& from, const fs::path& to) const {
    return error_of(::rename(from.c_str(), to.c_str()));
}

int PosixStorage::remove(const fs::path& path) const {
    return error_of(::unlink(path.c_str()));
}

fs::file_status PosixStorage::status(const fs::path& path) const {
    return fs::status(path);
}

fs::path PosixStorage::canonical(const fs::path& path) const {
    return fs::canonical(path);
}

std::variant<std::unique_ptr<File>, LockHolder> PosixStorage::hold(const fs::path& path, const std::string& who) const {
    const int file = open_or_make(path.string());
    if (file < 0) throw std::system_error(errno, std::generic_category(), path.string());
    auto held = std::make_unique<PosixFile>(file);
    if (!locks(file)) return read_holder(file);
    const std::string line = who + "\n";
    // Only for the message of a second program.
    static_cast<void>(ftruncate(file, 0) == 0 && pwrite(file, line.data(), line.size(), 0) > 0);
    return held;
}

std::optional<LockHolder> PosixStorage::held_by(const fs::path& path) const {
    const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
    if (!file.is_open() || flock(file.get(), LOCK_SH | LOCK_NB) == 0 || errno != EWOULDBLOCK) return std::nullopt;
    return read_holder(file.get());
}

}  // namespace settings
