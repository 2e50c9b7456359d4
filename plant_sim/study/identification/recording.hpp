/// What a rig said during one maneuver, as the identification reads it: one sample a control period, decoded, in SI units. Where it comes
/// from (a bus log, a rig in process) is the caller's business.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace identification {

/// Phases of a maneuver by their codes on the bus.
namespace phase {
inline constexpr std::uint8_t kTouchdown = 2, kSettling = 3, kBraking = 4, kStandstill = 5, kRetract = 6;
}

/// A toothed encoder: edges so far (modulo 2^32), and when the last one came by the sensor's own clock.
struct Edges {
    std::uint32_t count = 0;
    double time_s = 0.0;
};

struct Sample {
    double time_s = 0.0;  ///< on the bus; steps of one period, more where samples are missing
    std::uint8_t phase = 0;
    double current_mA = 0.0;   ///< valve current from here to the next sample
    double pressure_Pa = 0.0;  ///< at the brake, measured
    Edges wheel, flywheel;
    bool cells_new = false;  ///< the load cells below were read since the last sample
    double vertical_N = 0.0;
    double longitudinal_N = 0.0;
};

struct Recording {
    std::string name;  ///< for people: its folder
    double period_s = 1e-3;
    std::vector<Sample> samples;
};

/// What is known of the rig beforehand: geometry, which no brake test shows.
struct KnownRig {
    double wheel_teeth = 60.0;
    double flywheel_teeth = 60.0;
    double flywheel_radius_m = 0.0;    ///< R_f
    double mass_kg = 0.0;              ///< J_f / R_f^2
    double stiffness_Npm = 0.0;        ///< k_r of r(F_z) = r_0 - F_z / k_r
    double brake_gain_m3 = 0.0;        ///< A_p N_p N_s R_eff, eq. (5)
    double edge_jitter_s = 1e-6;       ///< of an encoder's time stamps, standard deviation
    double gauge_range_Pa = 0.0;       ///< of the pressure transducer
    std::vector<double> map_currents;  ///< mA, where the static map is wanted: rising, two or more
};

/// A recording, and the rig and road that it was made on.
struct Run {
    Recording recording;
    KnownRig rig;
    std::string surface;         ///< its name
    std::string friction_class;  ///< of the brake's friction over the stop: light, medium, heavy
};

/// The recordings do not show what was asked for: says which experiment is missing, or what is wrong with it and what would be right.
class NotIdentifiable : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Throws NotIdentifiable for a recording with a value that is no number, or with time going backwards.
void check(const Recording& recording);

}  // namespace identification
