#include "firmware/host/settings/input_file.hpp"

#include <array>
#include <cerrno>
#include <cstring>

namespace settings {

std::string read_file(const std::filesystem::path& path, std::size_t max, const Storage& storage) {
    const auto reject = [&path](const std::string& why) { throw Error(path.string(), 0, "", why); };

    const auto [file, error] = storage.open(path);
    if (!file) reject("cannot be opened: " + std::string(std::strerror(error)));
    std::string bytes;
    std::array<char, 65536> chunk{};
    while (true) {
        const std::int64_t count = file->read(chunk);
        if (count == 0) return bytes;
        if (count == -EISDIR) reject("is a directory, not a file");
        if (count < 0) reject("cannot be read: " + std::string(std::strerror(static_cast<int>(-count))));
        bytes.append(chunk.data(), static_cast<std::size_t>(count));
        if (bytes.size() > max) reject("is larger than " + std::to_string(max >> 20U) + " MiB");
    }
}

}  // namespace settings
