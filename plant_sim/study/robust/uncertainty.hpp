/// What is not known about a plant, as ranges, and plants drawn from them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "plant_sim/study/rig_session.hpp"

namespace robust {

/// Which ranges a draw takes; `changes` and `brake_on` take none, they are grids (grids.hpp).
enum class Family : std::uint8_t { paper, ring, relaxation, leg, parameters, patches, speed, all, changes, brake_on };
inline constexpr std::array<std::string_view, 10> kFamilyNames{"paper",   "ring",  "relaxation", "leg",     "parameters",
                                                               "patches", "speed", "all",        "changes", "brake_on"};
inline constexpr std::size_t kDrawnFamilies = 8;  ///< of them, from the front
[[nodiscard]] constexpr std::string_view name(Family family) {
    return kFamilyNames[static_cast<std::size_t>(family)];
}

struct Interval {
    double low = 0.0, high = 0.0;
};

/// config/uncertainty.toml; its comments say what each is.
struct Uncertainty {
    double slip_reference = 0.0;
    Interval speed_mps;
    Interval belt_share, ring_Hz, ring_damping;
    Interval relaxation_m;
    double relaxation_floor_m = 0.0;
    Interval leg_kg, leg_Hz, leg_damping;
    Interval wheel_inertia, brake_gain, valve_frequency, delay_s, hysteresis_mA, load, pitch_error, eccentricity;
    Interval patch_m;
    std::vector<double> change_mps;    ///< of the grid `changes`
    std::vector<double> brake_on_mps;  ///< of the grid `brake_on`, slowest first
};
/// Throws settings::Error.
[[nodiscard]] Uncertainty load_uncertainty(const std::filesystem::path& file);

/// A landing before anything is drawn.
struct Landing {
    std::string surface, maneuver;
    rig::RigParameters rig;
};

/// What a draw takes from.
struct Basis {
    Uncertainty uncertainty;
    std::vector<Landing> landings;       ///< one of them
    std::vector<rig::Surface> surfaces;  ///< of the patches
};

struct Draw {
    std::size_t landing = 0;
    rig::RigParameters rig;
};

/// Draw `number` of a family: that, the family and the seed decide everything. Landings come in turn, so that every family has all of them.
/// A grid begins again after its last stop.
[[nodiscard]] Draw draw(const Basis& basis, Family family, std::uint64_t seed, std::size_t number);

/// What was drawn, for a person: "heavy snow, ring 73.2 Hz damping 0.050 belt 0.31". Of patches the first four.
[[nodiscard]] std::string describe(const Basis& basis, const Draw& draw);

}  // namespace robust
