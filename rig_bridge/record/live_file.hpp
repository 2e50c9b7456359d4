/// A file for writers that must not wait for the disk: lines are queued; a thread writes them and syncs every second, so that a power cut loses at
/// most the last two seconds, and a hanging disk delays no step.
///
/// The queue holds some 20 s of a full bus at 1 Mbit/s. While it is full, lines are dropped, counted and reported by error().
#pragma once

#include <condition_variable>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "rig_bridge/record/append_file.hpp"
#include "rig_bridge/record/line_file.hpp"

namespace rig::record {

struct LiveFileOptions {
    std::size_t queue_bytes = std::size_t{8} << 20U;
    /// Called by the thread before each write, for tests with a slow disk.
    std::function<void()> before_write = nullptr;
};

class LiveFile final : public LineFile {
  public:
    /// As AppendFile.
    explicit LiveFile(const std::filesystem::path& path, LiveFileOptions options = {}, const settings::Storage& storage = settings::PosixStorage{});
    ~LiveFile() override;

    /// Waits for no disk.
    void line(std::string_view text) override;
    /// No effect: the thread writes within kWrite_ms anyway.
    void flush() override {}
    /// Waits for the disk.
    bool finish() override;

    [[nodiscard]] std::uint64_t lines() const override;
    [[nodiscard]] std::uint64_t missing() const override;
    [[nodiscard]] std::string error() const override;

  private:
    static constexpr int kWrite_ms = 100;
    void run();
    void write_queued();

    LiveFileOptions options_;
    std::filesystem::path path_;
    AppendFile file_;            // used by the thread, and by finish() after the thread has ended
    std::string being_written_;  // the same

    mutable std::mutex mutex_;  // held for copies only
    std::condition_variable wake_;
    std::string queue_;
    std::uint64_t lines_ = 0;
    std::uint64_t rejected_ = 0;
    std::uint64_t lost_ = 0;  // by the disk
    std::string error_;       // of the disk
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace rig::record
