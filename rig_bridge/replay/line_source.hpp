/// Reads lines of a file, plain or gzip (detected by its first bytes), or of a pipe, in constant memory; or lines of a text.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

struct gzFile_s;

namespace rig::replay {

/// A whole log in memory.
struct LogText {
    std::string_view bytes;
};

class LineSource {
  public:
    /// Longer lines are cut to this and flagged.
    static constexpr std::size_t kLongest = 4096;

    struct Line {
        std::string_view text;     ///< without its end; valid until the next call of next()
        std::uint64_t number = 0;  ///< from 1
        bool ended = true;         ///< false: the file ends without a line end
        bool too_long = false;     ///< `text` is the first part
    };

    /// Throws std::runtime_error naming the file and the reason when it cannot be opened.
    explicit LineSource(const std::filesystem::path& file);
    /// Reads from a pipe; the caller keeps its descriptor.
    explicit LineSource(int pipe);
    /// Reads `text`, which must outlive it.
    explicit LineSource(LogText text) : bytes_(text.bytes.data()), end_(text.bytes.size()), at_end_(true) {}

    /// False at the end; check damage() then.
    [[nodiscard]] bool next(Line& line);

    /// Why reading ended before the end of the file; empty: the file is complete.
    [[nodiscard]] const std::string& damage() const { return damage_; }
    /// Number of lines returned so far.
    [[nodiscard]] std::uint64_t lines() const { return number_; }
    /// Share of the file that was read, 0 to 1.
    [[nodiscard]] double share() const;

  private:
    struct Close {
        void operator()(gzFile_s* file) const;
    };
    /// Moves the rest of the block to its front and reads more; false if there is no more.
    bool refill();
    bool skip_long_line();

    std::unique_ptr<gzFile_s, Close> file_;
    double size_ = 0.0;              // bytes
    std::unique_ptr<char[]> block_;  // none: a text
    const char* bytes_;              // of the block, or the text
    std::size_t begin_ = 0;
    std::size_t end_ = 0;
    bool at_end_ = false;
    bool in_long_line_ = false;
    std::uint64_t number_ = 0;
    std::string damage_;
};

}  // namespace rig::replay
