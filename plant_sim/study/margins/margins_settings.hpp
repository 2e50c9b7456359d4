/// Reads config/margins.toml.
#pragma once

#include <filesystem>

#include "plant_sim/study/margins/limits.hpp"
#include "plant_sim/study/margins/pid_loop.hpp"

namespace study::margins {

struct MarginsSettings {
    Requirement requirement;
    Pid pid;
};

/// Throws settings::Error naming file, line and key.
[[nodiscard]] MarginsSettings load_margins_settings(const std::filesystem::path& path);

}  // namespace study::margins
