#include "firmware/host/settings/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "firmware/host/settings/file_descriptor.hpp"

namespace settings {

std::string read_file(const std::filesystem::path& path, std::size_t max) {
    const auto reject = [&path](const std::string& why) { throw Error(path.string(), 0, "", why); };

    const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (!file.is_open()) reject("cannot be opened: " + std::string(std::strerror(errno)));
    struct stat status {};
    if (::fstat(file.get(), &status) != 0) reject("cannot be read: " + std::string(std::strerror(errno)));
    if (S_ISDIR(status.st_mode)) reject("is a directory, not a file");

    std::string bytes;
    std::array<char, 65536> chunk{};
    while (true) {
        const auto count = ::read(file.get(), chunk.data(), chunk.size());
        if (count == 0) return bytes;
        if (count < 0) {
            if (errno == EINTR) continue;
            reject("cannot be read: " + std::string(std::strerror(errno)));
        }
        bytes.append(chunk.data(), static_cast<std::size_t>(count));
        if (bytes.size() > max) reject("is larger than " + std::to_string(max >> 20U) + " MiB");
    }
}

}  // namespace settings
