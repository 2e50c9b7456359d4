/// The disk as those see it who keep records on it: handed in, so that a test can hand in one that fills up, refuses and loses its power.
///
/// What fails is an errno; 0 where it is done.
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

/// Closed when it goes.
class File {
  public:
    File() = default;
    virtual ~File() = default;
    File(const File&) = delete;
    File& operator=(const File&) = delete;

    /// How many bytes, maybe fewer than asked for, or the negative of an errno. Reading: none at the end.
    [[nodiscard]] virtual std::int64_t read(std::span<char> bytes) = 0;
    [[nodiscard]] virtual std::int64_t append(std::string_view bytes) = 0;
    [[nodiscard]] virtual int truncate(std::int64_t size) = 0;
    /// Its bytes survive a power cut; its name does so after Storage::sync_directory().
    [[nodiscard]] virtual int sync() = 0;
    [[nodiscard]] virtual int close() = 0;
};

struct Opened {
    std::unique_ptr<File> file;  ///< none: see `error`
    int error = 0;
};

/// Who has a file that is held: what that program wrote there, empty where it wrote nothing.
struct HeldBy {
    std::string who;
};

class Storage {
  public:
    Storage() = default;
    virtual ~Storage() = default;
    Storage(const Storage&) = delete;
    Storage& operator=(const Storage&) = delete;

    [[nodiscard]] virtual Opened open(const std::filesystem::path& path) const = 0;    ///< to read
    [[nodiscard]] virtual Opened create(const std::filesystem::path& path) const = 0;  ///< EEXIST: is there already
    [[nodiscard]] virtual int make_directory(const std::filesystem::path& path) const = 0;
    /// The names in it survive a power cut.
    [[nodiscard]] virtual int sync_directory(const std::filesystem::path& path) const = 0;
    [[nodiscard]] virtual int rename(const std::filesystem::path& from, const std::filesystem::path& to) const = 0;
    [[nodiscard]] virtual int remove(const std::filesystem::path& path) const = 0;
    /// Links followed. Throws std::filesystem::filesystem_error.
    [[nodiscard]] virtual std::filesystem::file_status status(const std::filesystem::path& path) const = 0;
    /// Absolute, without links.
    [[nodiscard]] virtual std::filesystem::path canonical(const std::filesystem::path& path) const = 0;

    /// Takes `path` for this program alone until the file goes or the program dies, however it dies; the file stays. It is made where it is not
    /// there, and `who` written into it, one line for whoever comes second. Throws std::system_error naming the file.
    [[nodiscard]] virtual std::variant<std::unique_ptr<File>, HeldBy> hold(const std::filesystem::path& path, const std::string& who) const = 0;
    /// Whether somebody has it now, and who: for those who only look. Nothing where the file is not there or cannot be read.
    [[nodiscard]] virtual std::optional<HeldBy> held_by(const std::filesystem::path& path) const = 0;

    /// Name of the SQLite VFS that reaches the same files; null: the one that SQLite brings.
    [[nodiscard]] virtual const char* sqlite_vfs() const { return nullptr; }
};

/// The computer's own.
class PosixStorage final : public Storage {
  public:
    [[nodiscard]] Opened open(const std::filesystem::path& path) const override;
    [[nodiscard]] Opened create(const std::filesystem::path& path) const override;
    [[nodiscard]] int make_directory(const std::filesystem::path& path) const override;
    [[nodiscard]] int sync_directory(const std::filesystem::path& path) const override;
    [[nodiscard]] int rename(const std::filesystem::path& from, const std::filesystem::path& to) const override;
    [[nodiscard]] int remove(const std::filesystem::path& path) const override;
    [[nodiscard]] std::filesystem::file_status status(const std::filesystem::path& path) const override;
    [[nodiscard]] std::filesystem::path canonical(const std::filesystem::path& path) const override;
    /// By flock(2).
    [[nodiscard]] std::variant<std::unique_ptr<File>, HeldBy> hold(const std::filesystem::path& path, const std::string& who) const override;
    [[nodiscard]] std::optional<HeldBy> held_by(const std::filesystem::path& path) const override;
};

}  // namespace settings
