#include "rig_bridge/record/append_file.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "firmware/host/settings/atomic_file.hpp"

namespace rig::record {

namespace {

constexpr std::size_t kBuffer = 1U << 16U;
constexpr std::size_t kLongestLine = 4096;

std::unique_ptr<settings::File> create(const std::filesystem::path& path, const settings::Storage& storage) {
    if (path.has_parent_path()) settings::create_directories(path.parent_path(), storage);
    settings::OpenResult opened = storage.create(path);
    if (opened.error == 0) opened.error = storage.sync_directory(path.parent_path());
    if (opened.error != 0) throw std::runtime_error(path.string() + ": " + std::strerror(opened.error));
    return std::move(opened.file);
}

}  // namespace

AppendFile::AppendFile(const std::filesystem::path& path, const settings::Storage& storage) : path_(path), file_(create(path, storage)) {
    buffer_.reserve(kBuffer);
}

AppendFile::~AppendFile() {
    if (file_) finish();
}

void AppendFile::line(std::string_view text) {
    ++lines_;
    if (error_ != 0 || text.size() > kLongestLine) {
        ++missing_;
        return;
    }
    if (buffer_.size() + text.size() + 1 > kBuffer) {
        flush();
        if (error_ != 0) {
            ++missing_;
            return;
        }
    }
    buffer_.append(text);
    buffer_.push_back('\n');
    ++lines_in_buffer_;
}

void AppendFile::flush() {
    if (error_ != 0) return;
    std::size_t done = 0;
    while (done < buffer_.size()) {
        const std::int64_t written = file_->append(std::string_view(buffer_).substr(done));
        if (written <= 0) {
            // Complete lines that reached the disk count; an incomplete last one is cut off.
            const auto begin = buffer_.begin();
            const auto end = begin + static_cast<std::ptrdiff_t>(done);
            lines_in_buffer_ -= static_cast<std::uint64_t>(std::count(begin, end, '\n'));
            const auto last = std::find(std::make_reverse_iterator(end), std::make_reverse_iterator(begin), '\n').base();
            size_ += last - begin;
            fail(written < 0 ? static_cast<int>(-written) : EIO);
            return;
        }
        done += static_cast<std::size_t>(written);
    }
    size_ += static_cast<std::int64_t>(buffer_.size());
    buffer_.clear();
    lines_in_buffer_ = 0;
}

void AppendFile::fail(int error) {
    error_ = error;
    missing_ += lines_in_buffer_;
    lines_in_buffer_ = 0;
    buffer_.clear();
    // If this fails, too, the last line stays incomplete; readers report it.
    static_cast<void>(file_->truncate(size_));
}

void AppendFile::sync() {
    flush();
    if (error_ == 0) error_ = file_->sync();
}

bool AppendFile::finish() {
    if (!file_) return error_ == 0;
    flush();
    const int synced = file_->sync();
    const int closed = file_->close();
    if (error_ == 0) error_ = synced != 0 ? synced : closed;
    file_.reset();
    return error_ == 0 && missing_ == 0;
}

std::string AppendFile::error() const {
    if (error_ == 0 && missing_ == 0) return {};
    std::string text = path_.string() + ": " + (error_ != 0 ? std::strerror(error_) : "a line is too long");
    return text + "; " + std::to_string(missing_) + (missing_ == 1 ? " line is missing" : " lines are missing");
}

}  // namespace rig::record
