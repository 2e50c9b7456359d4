/// Result files that are whole or not there.
#pragma once

#include <filesystem>
#include <string_view>

#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/storage.hpp"

namespace settings {

/// Writes `bytes` to a temporary file beside `path`, fsyncs it, renames it to `path` and fsyncs the
/// directory: after a crash, a full disk or a kill, `path` holds all of the old bytes or all of the new.
/// Missing parent directories are created. A symbolic link is followed. Error naming `path` when anything
/// fails, and when `path` is there but is no regular file (a rename would replace a device or a pipe); the
/// temporary file is then removed. Permissions are 0666 less the umask.
void write_file(const std::filesystem::path& path, std::string_view bytes, const Storage& storage = PosixStorage{});

/// `directory` with its missing parents, each fsynced in its own parent: a power cut does not take them away with what is in them. Error
/// naming `directory`.
void create_directories(const std::filesystem::path& directory, const Storage& storage = PosixStorage{});

}  // namespace settings
