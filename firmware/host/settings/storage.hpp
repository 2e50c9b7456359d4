/// Interface to the disk for programs that keep records; injected, so that tests can simulate a full disk, errors and power cuts.
///
/// Functions returning int return 0, or the errno of the failure.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace settings {

/// An open file; the destructor closes it.
class File {
  public:
    File() = default;
    virtual ~File() = default;
    File(const File&) = delete;
    File& operator=(const File&) = delete;

    /// read() and append() return the number of bytes, which may be less than requested, or a negative errno. read() returns 0 at the end of the
    /// file.
    [[nodiscard]] virtual std::int64_t read(std::span<char> bytes) = 0;
    [[nodiscard]] virtual std::int64_t append(std::string_view bytes) = 0;
    [[nodiscard]] virtual int truncate(std::int64_t size) = 0;
    /// fsync: the file's bytes survive a power cut. Its name does after Storage::sync_directory().
    [[nodiscard]] virtual int sync() = 0;
    [[nodiscard]] virtual int close() = 0;
};

struct OpenResult {
    std::unique_ptr<File> file;  ///< none: see `error`
    int error = 0;
};

/// The text that the program holding a file has written into it; empty if it wrote none.
struct LockHolder {
    std::string who;
};

class Storage {
  public:
    Storage() = default;
    virtual ~Storage() = default;
    Storage(const Storage&) = delete;
    Storage& operator=(const Storage&) = delete;

    [[nodiscard]] virtual OpenResult open(const std::filesystem::path& path) const = 0;    ///< to read
    [[nodiscard]] virtual OpenResult create(const std::filesystem::path& path) const = 0;  ///< EEXIST: exists already
    [[nodiscard]] virtual int make_directory(const std::filesystem::path& path) const = 0;
    /// fsync: the names in the directory survive a power cut.
    [[nodiscard]] virtual int sync_directory(const std::filesystem::path& path) const = 0;
    [[nodiscard]] virtual int rename(const std::filesystem::path& from, const std::filesystem::path& to) const = 0;
    [[nodiscard]] virtual int remove(const std::filesystem::path& path) const = 0;
    /// Links followed. Throws std::filesystem::filesystem_error.
    [[nodiscard]] virtual std::filesystem::file_status status(const std::filesystem::path& path) const = 0;
    /// Absolute path without symbolic links.
    [[nodiscard]] virtual std::filesystem::path canonical(const std::filesystem::path& path) const = 0;

    /// Locks `path` exclusively until the returned file is destroyed or the program ends, in whatever way; the file itself remains. Creates it if
    /// needed and writes `who` into it, one line that a second program can report. Throws std::system_error naming the file.
    [[nodiscard]] virtual std::variant<std::unique_ptr<File>, LockHolder> hold(const std::filesystem::path& path, const std::string& who) const = 0;
    /// The holder, without locking; none if the file is not held, is missing or cannot be read.
    [[nodiscard]] virtual std::optional<LockHolder> held_by(const std::filesystem::path& path) const = 0;

    /// Name of the SQLite VFS for the same files; null: SQLite's default.
    [[nodiscard]] virtual const char* sqlite_vfs() const { return nullptr; }
};

/// The computer's file system.
class PosixStorage final : public Storage {
  public:
    [[nodiscard]] OpenResult open(const std::filesystem::path& path) const override;
    [[nodiscard]] OpenResult create(const std::filesystem::path& path) const override;
    [[nodiscard]] int make_directory(const std::filesystem::path& path) const override;
    [[nodiscard]] int sync_directory(const std::filesystem::path& path) const override;
    [[nodiscard]] int rename(const std::filesystem::path& from, const std::filesystem::path& to) const override;
    [[nodiscard]] int remove(const std::filesystem::path& path) const override;
    [[nodiscard]] std::filesystem::file_status status(const std::filesystem::path& path) const override;
    [[nodiscard]] std::filesystem::path canonical(const std::filesystem::path& path) const override;
    /// By flock(2).
    [[nodiscard]] std::variant<std::unique_ptr<File>, LockHolder> hold(const std::filesystem::path& path, const std::string& who) const override;
    [[nodiscard]] std::optional<LockHolder> held_by(const std::filesystem::path& path) const override;
};

}  // namespace settings
