/// Writes result files atomically: a reader sees all of a file or none of it.
#pragma once

#include <filesystem>
#include <string_view>

#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/storage.hpp"

namespace settings {

/// Writes `bytes` to a temporary file beside `path`, fsyncs it, renames it to `path` and fsyncs the
/// directory: after a crash, a full disk or a kill, `path` holds all of the old bytes or all of the new.
/// Missing parent directories are created. A symbolic link is followed. Throws Error naming `path` if anything fails, or if `path` exists and is not
/// a regular file (a rename would replace a device or a pipe); the temporary file is then removed. Permissions are 0666 less the umask.
void write_file(const std::filesystem::path& path, std::string_view bytes, const Storage& storage = PosixStorage{});

/// Creates `directory` and its missing parents and fsyncs each in its parent, so that they survive a power cut. Throws Error naming `directory`.
void create_directories(const std::filesystem::path& directory, const Storage& storage = PosixStorage{});

}  // namespace settings
