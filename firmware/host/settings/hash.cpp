#include "firmware/host/settings/hash.hpp"

#include <xxhash.h>

#include <vector>

#include "firmware/host/settings/input_file.hpp"

namespace settings {

namespace {

std::string digest(std::string_view bytes) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits(bytes.data(), bytes.size()));
    std::string hexadecimal;
    for (const unsigned char byte : canonical.digest) {
        hexadecimal += kDigits[byte >> 4U];
        hexadecimal += kDigits[byte & 0xFU];
    }
    return hexadecimal;
}

}  // namespace

std::string hash_bytes(std::span<const std::string_view> contents) {
    std::string lines;
    for (const auto bytes : contents) lines += digest(bytes) + "\n";
    return digest(lines);
}

std::string hash(std::span<const std::filesystem::path> files) {
    std::vector<std::string> contents;
    for (const auto& file : files) contents.push_back(read_file(file));
    return hash_bytes(std::vector<std::string_view>(contents.begin(), contents.end()));
}

}  // namespace settings
