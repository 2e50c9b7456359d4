#include "firmware/host/settings/atomic_file.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <deque>
#include <memory>
#include <string>
#include <utility>

namespace settings {

namespace fs = std::filesystem;

namespace {

/// Throws for the file the caller asked for, whatever file the failing call was about.
class Rejection {
  public:
    explicit Rejection(const fs::path& path) : file_(path.string()) {}
    [[noreturn]] void because(const std::string& why) const { throw Error(file_, 0, "", why); }
    void if_failed(const std::string& what, int error) const {
        if (error != 0) because(what + ": " + std::strerror(error));
    }

  private:
    std::string file_;
};

/// Removed when it goes, unless it was renamed first.
class TemporaryFile {
  public:
    /// The name does not build on the target's, which may already be as long as the file system allows.
    TemporaryFile(const fs::path& directory, const Storage& storage, const Rejection& rejection) : storage_(storage) {
        for (int attempt = 0; !file_; ++attempt) {
            path_ = directory / (".write-" + std::to_string(::getpid()) + "-" + std::to_string(attempt) + ".tmp");
            OpenResult opened = storage_.create(path_);
            if (opened.error != EEXIST) rejection.if_failed("cannot be written in its directory", opened.error);
            file_ = std::move(opened.file);
        }
    }
    ~TemporaryFile() {
        if (!path_.empty()) static_cast<void>(storage_.remove(path_));
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    void write(std::string_view bytes, const Rejection& rejection) {
        while (!bytes.empty()) {
            const std::int64_t count = file_->append(bytes);
            if (count < 0) rejection.if_failed("cannot be written", static_cast<int>(-count));
            bytes.remove_prefix(static_cast<std::size_t>(count));
        }
        rejection.if_failed("cannot be stored", file_->sync());
        rejection.if_failed("cannot be stored", file_->close());
    }

    void rename_to(const fs::path& target, const Rejection& rejection) {
        rejection.if_failed("cannot be put in place", storage_.rename(path_, target));
        path_.clear();
    }

  private:
    const Storage& storage_;
    fs::path path_;
    std::unique_ptr<File> file_;
};

void sync_directory(const fs::path& directory, const Storage& storage, const Rejection& rejection) {
    rejection.if_failed("directory cannot be stored", storage.sync_directory(directory));
}

/// Creates `directory` and its missing parents, each synced in its own parent.
void create_directories(const fs::path& directory, const Storage& storage, const Rejection& rejection) {
    std::deque<fs::path> missing;
    for (auto path = directory; !fs::exists(storage.status(path)); path = path.parent_path()) missing.push_front(path);
    for (const auto& path : missing) {
        const int error = storage.make_directory(path);
        if (error != EEXIST) rejection.if_failed("directory " + path.string() + " cannot be created", error);
        sync_directory(path.parent_path(), storage, rejection);
    }
}

}  // namespace

void create_directories(const fs::path& directory, const Storage& storage) {
    const Rejection rejection(directory);
    try {
        const fs::path whole = fs::absolute(directory);
        fs::path there = whole;
        while (!fs::exists(storage.status(there))) there = there.parent_path();
        // Whoever made it may have died, or been refused, before its name was on the disk. EACCES: made by somebody who may read what we may not.
        if (const int error = storage.sync_directory(there.parent_path()); error != EACCES) rejection.if_failed("directory cannot be stored", error);
        create_directories(whole, storage, rejection);
    } catch (const fs::filesystem_error& error) {
        rejection.if_failed("cannot be created", error.code().value());
    }
}

void write_file(const fs::path& path, std::string_view bytes, const Storage& storage) {
    const Rejection rejection(path);
    if (!path.has_filename()) rejection.because("is not the name of a file");
    try {
        const auto status = storage.status(path);
        if (fs::is_directory(status)) rejection.because("is a directory, not a file");
        if (fs::exists(status) && !fs::is_regular_file(status))
            rejection.because("is a device, pipe or socket; results are only written to regular files");
        const auto target = fs::exists(status) ? storage.canonical(path) : fs::absolute(path);

        create_directories(target.parent_path(), storage, rejection);
        TemporaryFile temporary(target.parent_path(), storage, rejection);
        temporary.write(bytes, rejection);
        temporary.rename_to(target, rejection);
        sync_directory(target.parent_path(), storage, rejection);
    } catch (const fs::filesystem_error& error) {
        rejection.if_failed("cannot be written", error.code().value());
    }
}

}  // namespace settings
