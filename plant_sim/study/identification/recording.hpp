/// Recording of one maneuver as the identification uses it: one decoded sample per control period, in SI units. The caller gets it from a bus log or
/// a rig in process.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace identification {

/// Codes of a maneuver's phases on the bus.
namespace phase {
inline constexpr std::uint8_t kTouchdown = 2, kSettling = 3, kBraking = 4, kStandstill = 5, kRetract = 6;
}

/// Data of a toothed encoder: number of edges (modulo 2^32), and time of the last one on the sensor's clock.
struct Edges {
    std::uint32_t count = 0;
    double time_s = 0.0;
};

struct Sample {
    double time_s = 0.0;  ///< on the bus; steps of one period, or more if samples are missing
    std::uint8_t phase = 0;
    double current_mA = 0.0;   ///< valve current from this sample to the next
    double pressure_Pa = 0.0;  ///< at the brake, measured
    Edges wheel, flywheel;
    bool cells_new = false;  ///< whether the load cell values below are new
    double vertical_N = 0.0;
    double longitudinal_N = 0.0;
};

struct Recording {
    std::string name;  ///< name of its folder, for people
    double period_s = 1e-3;
    std::vector<Sample> samples;
};

/// Known data of the rig: geometry, which no brake test determines.
struct KnownRig {
    double wheel_teeth = 60.0;
    double flywheel_teeth = 60.0;
    double flywheel_radius_m = 0.0;    ///< R_f
    double mass_kg = 0.0;              ///< J_f / R_f^2
    double stiffness_Npm = 0.0;        ///< k_r of r(F_z) = r_0 - F_z / k_r
    double brake_gain_m3 = 0.0;        ///< A_p N_p N_s R_eff, eq. (5)
    double edge_jitter_s = 1e-6;       ///< of an encoder's time stamps, standard deviation
    double gauge_range_Pa = 0.0;       ///< of the pressure transducer
    std::vector<double> map_currents;  ///< currents of the requested map, mA: ascending, at least two
};

/// A recording with its rig and surface.
struct Run {
    Recording recording;
    KnownRig rig;
    std::string surface;         ///< its name
    std::string friction_class;  ///< of the brake's friction over the stop: light, medium, heavy
};

/// The recordings do not determine a requested parameter. The text says which experiment is missing, or what is wrong with it and what would be
/// right.
class NotIdentifiable : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Throws NotIdentifiable for a recording with a value that is not finite, or with decreasing time.
void check(const Recording& recording);

}  // namespace identification
