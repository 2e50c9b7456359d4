/// One hash of all files in use, to label results with their configuration.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "firmware/host/settings/error.hpp"

namespace settings {

/// 32 hexadecimal digits: XXH3-128 over one line per file, which is the XXH3-128 of that file's bytes in
/// hexadecimal. The order of the files matters, their names and directories do not. In a shell: for f in FILES; do xxhsum -q -H2 $f | cut -c1-32;
/// done | xxhsum -q -H2 Detects different files; no protection against forgery.
[[nodiscard]] std::string hash_bytes(std::span<const std::string_view> contents);

/// The same for files as they are now. Throws Error if one cannot be read. For a file that was read earlier, hash those bytes instead: it may have
/// changed.
[[nodiscard]] std::string hash(std::span<const std::filesystem::path> files);

}  // namespace settings
