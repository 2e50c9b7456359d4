/// What a fuzz target gets: the fuzzer's bytes, drawn from one after the other or lying in a file.
#pragma once

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "firmware/host/settings/file_descriptor.hpp"

namespace fuzz {

/// A violated property: the fuzzer keeps the input that led here.
inline void require(bool holds) {
    if (!holds) std::abort();
}

class Input {
  public:
    Input(const std::uint8_t* data, std::size_t size) : bytes_(data, size) {}

    [[nodiscard]] bool empty() const { return bytes_.empty(); }
    /// The next bytes as a number; zeros once there are no more.
    template <typename T>
    [[nodiscard]] T take() {
        T value{};
        const std::size_t count = std::min(sizeof value, bytes_.size());
        std::memcpy(&value, bytes_.data(), count);
        bytes_ = bytes_.subspan(count);
        return value;
    }
    [[nodiscard]] std::span<const std::uint8_t> rest() const { return bytes_; }
    [[nodiscard]] std::string_view text() const { return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()}; }

  private:
    std::span<const std::uint8_t> bytes_;
};

/// A file of this process, gone when it ends; for readers that open their input themselves. It is written over, not made anew: where
/// TMPDIR lies in memory an execution then costs no more than its reader.
class File {
  public:
    explicit File(const std::string& name) : path_(new_folder() / name), file_(::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {}
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    ~File() {
        std::error_code ignored;
        std::filesystem::remove_all(path_.parent_path(), ignored);
    }
    const std::filesystem::path& holding(std::string_view text) const {
        const auto size = static_cast<ssize_t>(text.size());
        if (::pwrite(file_.get(), text.data(), text.size(), 0) != size || ::ftruncate(file_.get(), size) != 0)
            throw std::runtime_error(path_.string() + ": cannot be written");
        return path_;
    }

  private:
    static std::filesystem::path new_folder() {
        std::string folder = (std::filesystem::temp_directory_path() / "antiskid_fuzz_XXXXXX").string();
        if (mkdtemp(folder.data()) == nullptr) throw std::runtime_error("no temporary directory");
        return folder;
    }

    std::filesystem::path path_;
    settings::FileDescriptor file_;
};

}  // namespace fuzz
