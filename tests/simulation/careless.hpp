/// A storage between program and disk with one mistake in it.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "firmware/host/settings/storage.hpp"

namespace simulation_test {

enum class Mistake : std::uint8_t {
    file_not_synced,
    directory_not_synced,
    renamed_before_sync,
    short_write_is_whole,
    refused_write_is_written,
    refused_sync_is_synced,
};

class CarelessFile final : public settings::File {
  public:
    CarelessFile(std::shared_ptr<settings::File> file, Mistake mistake) : file_(std::move(file)), mistake_(mistake) {}
    std::int64_t read(std::span<char> bytes) override { return file_->read(bytes); }
    std::int64_t append(std::string_view bytes) override {
        const std::int64_t count = file_->append(bytes);
        const bool wrong = count < 0 ? mistake_ == Mistake::refused_write_is_written : mistake_ == Mistake::short_write_is_whole;
        return wrong ? static_cast<std::int64_t>(bytes.size()) : count;
    }
    int truncate(std::int64_t size) override { return file_->truncate(size); }
    int sync() override {
        if (mistake_ == Mistake::file_not_synced || mistake_ == Mistake::renamed_before_sync) return 0;
        const int error = file_->sync();
        return mistake_ == Mistake::refused_sync_is_synced ? 0 : error;
    }
    int close() override { return file_->close(); }

  private:
    std::shared_ptr<settings::File> file_;
    Mistake mistake_;
};

class Careless final : public settings::Storage {
  public:
    Careless(std::shared_ptr<const settings::Storage> disk, Mistake mistake) : disk_(std::move(disk)), mistake_(mistake) {}

    settings::OpenResult open(const std::filesystem::path& path) const override { return disk_->open(path); }
    settings::OpenResult create(const std::filesystem::path& path) const override {
        settings::OpenResult opened = disk_->create(path);
        if (!opened.file) return opened;
        std::shared_ptr<settings::File> file = std::move(opened.file);
        // Only what is renamed is synced late; a log is synced as it grows.
        const bool late = mistake_ == Mistake::renamed_before_sync;
        if (late && path.extension() != ".tmp") return {.file = std::make_unique<CarelessFile>(file, Mistake::directory_not_synced)};
        if (late) *renamed_ = file;
        return {.file = std::make_unique<CarelessFile>(file, mistake_)};
    }
    int make_directory(const std::filesystem::path& path) const override { return disk_->make_directory(path); }
    int sync_directory(const std::filesystem::path& path) const override {
        return mistake_ == Mistake::directory_not_synced ? 0 : disk_->sync_directory(path);
    }
    int rename(const std::filesystem::path& from, const std::filesystem::path& to) const override {
        const int error = disk_->rename(from, to);
        if (error != 0 || !*renamed_) return error;
        const int directory = disk_->sync_directory(to.parent_path());
        const int synced = std::exchange(*renamed_, nullptr)->sync();
        return directory != 0 ? directory : synced;
    }
    int remove(const std::filesystem::path& path) const override { return disk_->remove(path); }
    std::filesystem::file_status status(const std::filesystem::path& path) const override { return disk_->status(path); }
    std::filesystem::path canonical(const std::filesystem::path& path) const override { return disk_->canonical(path); }
    std::variant<std::unique_ptr<settings::File>, settings::LockHolder> hold(const std::filesystem::path& path,
                                                                             const std::string& who) const override {
        return disk_->hold(path, who);
    }
    std::optional<settings::LockHolder> held_by(const std::filesystem::path& path) const override { return disk_->held_by(path); }
    const char* sqlite_vfs() const override { return disk_->sqlite_vfs(); }

  private:
    std::shared_ptr<const settings::Storage> disk_;
    Mistake mistake_;
    std::shared_ptr<std::shared_ptr<settings::File>> renamed_ = std::make_shared<std::shared_ptr<settings::File>>();
};

}  // namespace simulation_test
