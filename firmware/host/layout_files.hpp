/// The two files of the bus layout, as every program takes them.
#pragma once

#include <filesystem>
#include <numbers>

#include "firmware/can/load_layout.hpp"
#include "firmware/control/config.hpp"

namespace antiskid {

/// What a controller with this configuration may read and send.
[[nodiscard]] inline can::RequiredRange required_range(const control::Config& c) {
    const auto shaft = [&](const control::EncoderConfig& e) {
        const double radps = static_cast<double>(e.max_speed_radps);
        const double between_s = static_cast<double>(c.monitor.sensor_max_age_s + c.period_s);
        return can::RequiredRange::Shaft{.radps = radps, .edges = radps * static_cast<double>(e.teeth) / (2.0 * std::numbers::pi) * between_s};
    };
    return {.pressure_Pa = static_cast<double>(c.valve.full_pressure_Pa),
            .current_mA = static_cast<double>(c.valve.current_mA.at(c.valve.points - 1U)),
            .wheel = shaft(c.wheel.encoder),
            .flywheel = shaft(c.flywheel.encoder),
            .vertical_N = {},
            .longitudinal_N = {},
            .brake_torque_Nm = {}};
}

struct LayoutFiles {
    std::filesystem::path dbc, binding;

    /// `given_dbc`, `given_binding`: the user's; empty: antiskid.dbc and antiskid_binding.toml of `config`.
    explicit LayoutFiles(const std::filesystem::path& config, const std::filesystem::path& given_dbc = {},
                         const std::filesystem::path& given_binding = {})
        : dbc(given_dbc.empty() ? config / "antiskid.dbc" : given_dbc),
          binding(given_binding.empty() ? config / "antiskid_binding.toml" : given_binding) {}

    /// Throws as can::load_layout.
    [[nodiscard]] can::Layout load(const can::RequiredRange& required = {}) const { return can::load_layout(dbc, binding, required); }
};

}  // namespace antiskid
