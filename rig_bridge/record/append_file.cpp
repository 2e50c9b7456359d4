#include "rig_bridge/record/append_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "firmware/host/settings/atomic_file.hpp"

namespace rig::record {

namespace {

constexpr std::size_t kBuffer = 1U << 16U;
constexpr std::size_t kLongestLine = 4096;

int create(const std::filesystem::path& path) {
    if (path.has_parent_path()) settings::create_directories(path.parent_path());
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0) throw std::runtime_error(path.string() + ": " + std::strerror(errno));
    return descriptor;
}

}  // namespace

AppendFile::AppendFile(const std::filesystem::path& path) : path_(path), file_(create(path)) {
    settings::sync_directory(path.parent_path());
    buffer_.reserve(kBuffer);
}

AppendFile::~AppendFile() {
    if (file_.is_open()) finish();
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
    buffer_.insert(buffer_.end(), text.begin(), text.end());
    buffer_.push_back('\n');
    ++lines_in_buffer_;
}

void AppendFile::flush() {
    if (error_ != 0) return;
    std::size_t done = 0;
    while (done < buffer_.size()) {
        const ssize_t written = ::write(file_.get(), buffer_.data() + done, buffer_.size() - done);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) {
            const int error = written < 0 ? errno : EIO;
            // Whole lines that did get to the disk count; the piece of one after them is cut off.
            const auto begin = buffer_.begin();
            const auto end = begin + static_cast<std::ptrdiff_t>(done);
            lines_in_buffer_ -= static_cast<std::uint64_t>(std::count(begin, end, '\n'));
            const auto last = std::find(std::make_reverse_iterator(end), std::make_reverse_iterator(begin), '\n').base();
            size_ += last - begin;
            fail(error);
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
    // Where this fails, too, the last line stays a piece: readers name it.
    static_cast<void>(::ftruncate(file_.get(), size_) == 0);
}

void AppendFile::sync() {
    flush();
    if (error_ == 0 && ::fdatasync(file_.get()) != 0) error_ = errno;
}

bool AppendFile::finish() {
    if (!file_.is_open()) return error_ == 0;
    flush();
    if (::fsync(file_.get()) != 0 && error_ == 0) error_ = errno;
    if (!file_.close() && error_ == 0) error_ = errno;
    return error_ == 0 && missing_ == 0;
}

std::string AppendFile::error() const {
    if (error_ == 0 && missing_ == 0) return {};
    std::string text = path_.string() + ": " + (error_ != 0 ? std::strerror(error_) : "a line is too long");
    return text + "; " + std::to_string(missing_) + (missing_ == 1 ? " line is missing" : " lines are missing");
}

}  // namespace rig::record
