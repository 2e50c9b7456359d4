#include "firmware/host/settings/config_directory.hpp"

namespace settings {

std::filesystem::path config_directory() {
    std::error_code none;
    if (std::filesystem::is_directory("config", none)) return "config";
    return ANTISKID_CONFIG_DIRECTORY;
}

}  // namespace settings
