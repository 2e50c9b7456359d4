/// One short name for the exact bytes of the files in force, to stamp results with.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "firmware/host/settings/error.hpp"

namespace settings {

/// 32 hexadecimal digits: XXH3-128 over one line per file, which is the XXH3-128 of that file's bytes in
/// hexadecimal. Order counts, names and places do not. In a shell: for f in FILES; do xxhsum -q -H2 $f | cut
/// -c1-32; done | xxhsum -q -H2 It tells files apart; it is no protection against forgery.
[[nodiscard]] std::string hash_bytes(std::span<const std::string_view> contents);

/// The same of files as they are now. Error when one cannot be read. A file that was read earlier: hash the
/// bytes of that reading.
[[nodiscard]] std::string hash(std::span<const std::filesystem::path> files);

}  // namespace settings
