/// Unknown parameters of a plant as ranges, and plants drawn from them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "plant_sim/study/rig_session.hpp"

namespace robust {

/// Which ranges a draw uses. `changes` and `brake_on` use none: they are grids (grids.hpp).
enum class Family : std::uint8_t { paper, ring, relaxation, leg, parameters, patches, speed, all, curves, brakes, changes, brake_on };
inline constexpr std::array<std::string_view, 12> kFamilyNames{"paper", "ring", "relaxation", "leg",    "parameters", "patches",
                                                               "speed", "all",  "curves",     "brakes", "changes",    "brake_on"};
inline constexpr std::size_t kDrawnFamilies = 10;  ///< number of drawn families, which are the first
[[nodiscard]] constexpr std::string_view name(Family family) {
    return kFamilyNames[static_cast<std::size_t>(family)];
}

struct Interval {
    double low = 0.0, high = 0.0;
};

/// Contents of config/uncertainty.toml; its comments describe each value.
struct Uncertainty {
    double slip_reference = 0.0;
    Interval speed_mps;
    Interval belt_share, ring_Hz, ring_damping;
    Interval relaxation_m;
    double relaxation_floor_m = 0.0;
    Interval leg_kg, leg_Hz, leg_damping;
    Interval wheel_inertia, brake_gain, valve_frequency, delay_s, hysteresis_mA, load, pitch_error, eccentricity;
    Interval patch_m;
    Interval curve_peak_slip, curve_C, curve_E;
    Interval contact_Pa, piston_friction, run_out, warp, friction_brake_on, friction_half_way, friction_end;
    std::vector<double> change_mps;    ///< of the grid `changes`
    std::vector<double> brake_on_mps;  ///< of the grid `brake_on`, ascending
};
/// Throws settings::Error.
[[nodiscard]] Uncertainty load_uncertainty(const std::filesystem::path& file);

/// A landing with nominal parameters.
struct NominalLanding {
    std::string surface, maneuver;
    rig::RigParameters rig;
};

/// Inputs of the draws.
struct Basis {
    Uncertainty uncertainty;
    std::vector<NominalLanding> landings;  ///< each draw uses one
    std::vector<rig::Surface> surfaces;    ///< for the patches
};

struct Draw {
    std::size_t landing = 0;
    rig::RigParameters rig;
};

/// Draw `number` of a family, determined by number, family and seed. Landings alternate, so that every family has all of them. The number of a grid
/// counts modulo its size.
[[nodiscard]] Draw draw(const Basis& basis, Family family, std::uint64_t seed, std::size_t number);

/// The drawn values for people: "heavy snow, ring 73.2 Hz damping 0.050 belt 0.31". Of patches the first four.
[[nodiscard]] std::string describe(const Basis& basis, const Draw& draw);

}  // namespace robust
