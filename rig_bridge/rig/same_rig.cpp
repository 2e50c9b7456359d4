#include "rig_bridge/rig/same_rig.hpp"

#include <fmt/core.h>

#include <cmath>

#include "firmware/host/settings/error.hpp"

namespace rig {

void check_same_rig(const LoadedRig& loaded, const antiskid::control::Config& controller, const std::filesystem::path& controller_file) {
    const auto check = [&](const char* key, float controllers, double rigs) {
        constexpr double kRounding = 1e-6;  // of a float
        if (std::abs(static_cast<double>(controllers) - rigs) <= kRounding * rigs) return;
        throw settings::Error(controller_file.string(), 0, key,
                              fmt::format("is {:g}; expected {:g}, as in landing_gear.toml (Table III: flywheel_rig.toml)", controllers, rigs));
    };
    check("wheel.encoder.teeth", controller.wheel.encoder.teeth, loaded.rig.wheel_encoder.teeth);
    check("flywheel.encoder.teeth", controller.flywheel.encoder.teeth, loaded.rig.flywheel_encoder.teeth);
    check("flywheel.radius_m", controller.flywheel.radius_m, loaded.rig.flywheel_radius_m);
}

}  // namespace rig
