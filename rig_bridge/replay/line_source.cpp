#include "rig_bridge/replay/line_source.hpp"

#include <fcntl.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

namespace rig::replay {

namespace {

constexpr std::size_t kBlock = std::size_t{64} * 1024;
static_assert(kBlock > 2 * LineSource::kLongest);

}  // namespace

void LineSource::Close::operator()(gzFile_s* file) const {
    gzclose_r(file);
}

LineSource::LineSource(const std::filesystem::path& file) : block_(std::make_unique_for_overwrite<char[]>(kBlock)), bytes_(block_.get()) {
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) throw std::runtime_error(file.string() + ": is a directory; expected a bus log");
    errno = 0;
    file_.reset(gzopen(file.c_str(), "rb"));
    if (!file_) throw std::runtime_error(file.string() + ": cannot be read: " + std::strerror(errno));
    gzbuffer(file_.get(), kBlock / 2);
    const auto size = std::filesystem::file_size(file, error);
    if (!error) size_ = static_cast<double>(size);
}

LineSource::LineSource(int pipe)
    : file_(gzdopen(::fcntl(pipe, F_DUPFD_CLOEXEC, 0), "rb")), block_(std::make_unique_for_overwrite<char[]>(kBlock)), bytes_(block_.get()) {
    if (!file_) throw std::runtime_error(std::string("the pipe of a log's reader cannot be read: ") + std::strerror(errno));
}

double LineSource::share() const {
    return size_ > 0.0 ? std::clamp(static_cast<double>(gzoffset(file_.get())) / size_, 0.0, 1.0) : 1.0;
}

bool LineSource::refill() {
    if (at_end_) return false;
    std::memmove(block_.get(), block_.get() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
    // One read of a plain file goes directly into the block and returns at most the requested bytes.
    const int got = gzread(file_.get(), block_.get() + end_, static_cast<unsigned>(kBlock - end_));
    int code = Z_OK;
    const char* const says = gzerror(file_.get(), &code);
    if (got > 0) end_ += static_cast<std::size_t>(got);
    if (code == Z_ERRNO)
        damage_ = std::string("read error: ") + std::strerror(errno);
    else if (code == Z_BUF_ERROR)
        damage_ = "the gzip data are cut off";
    else if (code != Z_OK)
        damage_ = std::string("the gzip data are corrupt: ") + says;
    at_end_ = got <= 0 || code != Z_OK;
    return got > 0;
}

bool LineSource::skip_long_line() {
    while (in_long_line_) {
        const void* const found = std::memchr(bytes_ + begin_, '\n', end_ - begin_);
        in_long_line_ = found == nullptr;
        begin_ = found == nullptr ? end_ : static_cast<std::size_t>(static_cast<const char*>(found) - bytes_) + 1;
        if (in_long_line_ && !refill()) return false;
    }
    return true;
}

bool LineSource::next(Line& line) {
    if (!skip_long_line()) return false;
    std::size_t searched = 0;
    for (;;) {
        const char* const from = bytes_ + begin_;
        const std::size_t size = end_ - begin_;
        const void* const found = size > searched ? std::memchr(from + searched, '\n', size - searched) : nullptr;
        if (found != nullptr) {
            const auto length = static_cast<std::size_t>(static_cast<const char*>(found) - from);
            line = {{from, length < kLongest ? length : kLongest}, ++number_, true, length > kLongest};
            begin_ += length + 1;
            return true;
        }
        if (size > kLongest) {
            line = {{from, kLongest}, ++number_, true, true};
            in_long_line_ = true;
            return true;
        }
        searched = size;
        if (refill()) continue;
        if (begin_ == end_) return false;
        line = {{bytes_ + begin_, end_ - begin_}, ++number_, false, false};
        begin_ = end_;
        return true;
    }
}

}  // namespace rig::replay
