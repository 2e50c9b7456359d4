#include "firmware/host/settings/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <deque>
#include <string>

#include "firmware/host/settings/file_descriptor.hpp"

namespace settings {

namespace fs = std::filesystem;

namespace {

/// Throws for the file the caller asked for, whatever file the failing call was about.
class Rejection {
  public:
    explicit Rejection(const fs::path& path) : file_(path.string()) {}
    [[noreturn]] void because(const std::string& why) const { throw Error(file_, 0, "", why); }
    [[noreturn]] void of_system(const std::string& what, int code) const { because(what + ": " + std::strerror(code)); }

  private:
    std::string file_;
};

/// Removed when it goes, unless it was renamed first.
class TemporaryFile {
  public:
    TemporaryFile(const fs::path& directory, const Rejection& rejection) : path_(fresh(directory, rejection)), file_(descriptor_) {}
    ~TemporaryFile() {
        if (!path_.empty()) ::unlink(path_.c_str());
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    void write(std::string_view bytes, const Rejection& rejection) {
        while (!bytes.empty()) {
            const auto count = ::write(file_.get(), bytes.data(), bytes.size());
            if (count < 0 && errno != EINTR) rejection.of_system("cannot be written", errno);
            if (count > 0) bytes.remove_prefix(static_cast<std::size_t>(count));
        }
        if (::fsync(file_.get()) != 0) rejection.of_system("cannot be stored", errno);
        if (!file_.close()) rejection.of_system("cannot be stored", errno);
    }

    void rename_to(const fs::path& target, const Rejection& rejection) {
        if (::rename(path_.c_str(), target.c_str()) != 0) rejection.of_system("cannot be put in place", errno);
        path_.clear();
    }

  private:
    /// The name does not build on the target's, which may already be as long as the file system allows.
    fs::path fresh(const fs::path& directory, const Rejection& rejection) {
        for (int attempt = 0;; ++attempt) {
            auto path = directory / (".write-" + std::to_string(::getpid()) + "-" + std::to_string(attempt) + ".tmp");
            descriptor_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
            if (descriptor_ >= 0) return path;
            if (errno != EEXIST) rejection.of_system("cannot be written in its directory", errno);
        }
    }

    int descriptor_ = -1;
    fs::path path_;
    FileDescriptor file_;
};

void sync_directory(const fs::path& directory, const Rejection& rejection) {
    const FileDescriptor handle(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!handle.is_open()) rejection.of_system("directory cannot be stored", errno);
    // EINVAL: a file system that has no notion of syncing a directory.
    if (::fsync(handle.get()) != 0 && errno != EINVAL) rejection.of_system("directory cannot be stored", errno);
}

/// Creates `directory` and its missing parents, each synced in its own parent.
void create_directories(const fs::path& directory, const Rejection& rejection) {
    std::deque<fs::path> missing;
    for (auto path = directory; !fs::exists(path); path = path.parent_path()) missing.push_front(path);
    for (const auto& path : missing) {
        if (::mkdir(path.c_str(), 0777) != 0 && errno != EEXIST) rejection.of_system("directory " + path.string() + " cannot be created", errno);
        sync_directory(path.parent_path(), rejection);
    }
}

}  // namespace

void create_directories(const fs::path& directory) {
    const Rejection rejection(directory);
    try {
        create_directories(fs::absolute(directory), rejection);
    } catch (const fs::filesystem_error& error) {
        rejection.of_system("cannot be created", error.code().value());
    }
}

void sync_directory(const fs::path& directory) {
    sync_directory(directory.empty() ? fs::path(".") : directory, Rejection(directory));
}

void write_file(const fs::path& path, std::string_view bytes) {
    const Rejection rejection(path);
    if (!path.has_filename()) rejection.because("is not the name of a file");
    try {
        const auto status = fs::status(path);
        if (fs::is_directory(status)) rejection.because("is a directory, not a file");
        if (fs::exists(status) && !fs::is_regular_file(status))
            rejection.because("is a device, pipe or socket; results are only written to regular files");
        const auto target = fs::exists(status) ? fs::canonical(path) : fs::absolute(path);

        create_directories(target.parent_path(), rejection);
        TemporaryFile temporary(target.parent_path(), rejection);
        temporary.write(bytes, rejection);
        temporary.rename_to(target, rejection);
        sync_directory(target.parent_path(), rejection);
    } catch (const fs::filesystem_error& error) {
        rejection.of_system("cannot be written", error.code().value());
    }
}

}  // namespace settings
