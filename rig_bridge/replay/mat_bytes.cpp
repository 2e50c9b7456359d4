#include "rig_bridge/replay/mat_bytes.hpp"

#include <algorithm>
#include <array>

namespace rig::replay {

bool PlainBytes::take(std::span<unsigned char> out) {
    if (out.size() > left_.size()) return false;
    std::copy_n(left_.begin(), out.size(), out.begin());
    left_ = left_.subspan(out.size());
    return true;
}

bool PlainBytes::skip(std::uint64_t count) {
    if (count > left_.size()) return false;
    left_ = left_.subspan(count);
    return true;
}

InflatedBytes::InflatedBytes(std::span<const unsigned char> compressed) {
    stream_.next_in = const_cast<unsigned char*>(compressed.data());  // zlib only reads there
    stream_.avail_in = static_cast<uInt>(compressed.size());
    ready_ = inflateInit(&stream_) == Z_OK;
    more_ = ready_;
}

InflatedBytes::~InflatedBytes() {
    if (ready_) inflateEnd(&stream_);
}

bool InflatedBytes::take(std::span<unsigned char> out) {
    stream_.next_out = out.data();
    stream_.avail_out = static_cast<uInt>(out.size());
    while (more_ && stream_.avail_out > 0) more_ = inflate(&stream_, Z_SYNC_FLUSH) == Z_OK;
    return stream_.avail_out == 0;
}

bool InflatedBytes::skip(std::uint64_t count) {
    std::array<unsigned char, 16384> unused{};
    while (count > 0) {
        const std::size_t part = std::min<std::uint64_t>(count, unused.size());
        if (!take(std::span(unused).first(part))) return false;
        count -= part;
    }
    return true;
}

}  // namespace rig::replay
