/// Default directory of the configuration files.
#pragma once

#include <filesystem>

namespace settings {

/// `config` in the working directory if that exists (a checkout, or a user's own copy), else the installed one, /etc/antiskid in a Debian package.
[[nodiscard]] std::filesystem::path config_directory();

}  // namespace settings
