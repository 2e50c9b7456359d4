/// Where the programs look for configuration files unless the user says where.
#pragma once

#include <filesystem>

namespace settings {

/// `config` of the working directory, where that is a directory: a checkout, or a user's own copy. Else the installation's, /etc/antiskid in a
/// Debian package.
[[nodiscard]] std::filesystem::path config_directory();

}  // namespace settings
