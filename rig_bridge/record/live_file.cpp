#include "rig_bridge/record/live_file.hpp"

#include <chrono>
#include <utility>

namespace rig::record {

LiveFile::LiveFile(const std::filesystem::path& path, LiveFileOptions options, const settings::Storage& storage)
    : options_(std::move(options)), path_(path), file_(path, storage) {
    queue_.reserve(options_.queue_bytes);
    being_written_.reserve(options_.queue_bytes);
    thread_ = std::thread([this] { run(); });
}

LiveFile::~LiveFile() {
    finish();
}

void LiveFile::line(std::string_view text) {
    const std::lock_guard lock(mutex_);
    ++lines_;
    if (queue_.size() + text.size() + 1 > options_.queue_bytes) {
        ++rejected_;
        return;
    }
    queue_.append(text).push_back('\n');
}

void LiveFile::run() {
    using Clock = std::chrono::steady_clock;
    constexpr std::chrono::seconds kSync{1};
    Clock::time_point synced = Clock::now();
    while (true) {
        bool last = false;
        {
            std::unique_lock lock(mutex_);
            wake_.wait_for(lock, std::chrono::milliseconds(kWrite_ms), [this] { return stop_; });
            last = stop_;
            std::swap(queue_, being_written_);
        }
        if (options_.before_write) options_.before_write();
        write_queued();
        if (const auto now = Clock::now(); now - synced >= kSync) {
            file_.sync();
            synced = now;
        }
        const std::lock_guard lock(mutex_);
        lost_ = file_.missing();
        error_ = file_.error();
        if (last) return;
    }
}

void LiveFile::write_queued() {
    std::string_view rest = being_written_;
    for (std::size_t end = rest.find('\n'); end != std::string_view::npos; end = rest.find('\n')) {
        file_.line(rest.substr(0, end));
        rest.remove_prefix(end + 1);
    }
    being_written_.clear();
    file_.flush();
}

bool LiveFile::finish() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    wake_.notify_one();
    if (thread_.joinable()) thread_.join();
    const bool whole = file_.finish();
    const std::lock_guard lock(mutex_);
    lost_ = file_.missing();
    error_ = file_.error();
    return whole && rejected_ == 0;
}

std::uint64_t LiveFile::lines() const {
    const std::lock_guard lock(mutex_);
    return lines_;
}

std::uint64_t LiveFile::missing() const {
    const std::lock_guard lock(mutex_);
    return lost_ + rejected_;
}

std::string LiveFile::error() const {
    const std::lock_guard lock(mutex_);
    if (rejected_ == 0) return error_;
    return path_.string() + ": the disk does not keep up, the queue was full; " + std::to_string(rejected_) +
           (rejected_ == 1 ? " line is missing" : " lines are missing") + (error_.empty() ? "" : "; " + error_);
}

}  // namespace rig::record
