/// Open loop: the plant driven by a table of pressure or valve current, without controller (validation as in Section III.C, Fig. 5).
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "plant_sim/model/rig.hpp"

namespace study {

/// Quantity in the table's second column.
enum class DriveInput { pressure_Pa, current_mA };

struct DriveProfile {
    DriveInput input = DriveInput::pressure_Pa;
    std::vector<double> time_s;  ///< strictly increasing
    std::vector<double> value;   ///< linear between rows; constant before the first and after the last
};

/// Reads CSV with the header `time_s,pressure_Pa` or `time_s,current_mA` and at least two rows. Throws settings::Error naming file and line for a
/// missing or unknown column, text, NaN, values below 0 or above 100 MPa or 1 A, time that does not increase, or more than an hour.
[[nodiscard]] DriveProfile read_profile(const std::filesystem::path& csv);

/// The same checks for rows from elsewhere; errors name row i as line i + 1 of `name`.
[[nodiscard]] DriveProfile profile_of(const std::string& name, DriveInput input, std::span<const double> time_s, std::span<const double> value);

inline constexpr std::array kDriveColumns{"time_s", "speed_mps", "wheel_speed_radps", "slip", "pressure_Pa",    "brake_torque_Nm",
                                          "F_x_N",  "F_z_N",     "radius_m",          "mu",   "energy_brake_J", "energy_tyre_J"};
using DriveRow = std::array<double, kDriveColumns.size()>;

/// Drives the plant from the profile's first time, with the wheel rolling freely at the maneuver's speed, to the profile's end or standstill.
/// `on_row` is called at the start and after every step of 1 ms. Pressure follows the profile also between these rows; a current is sampled each
/// millisecond and linear in between.
void drive(const rig::RigParameters& rig, const DriveProfile& profile, const std::function<void(const DriveRow&)>& on_row);
/// The rows as CSV with a header.
[[nodiscard]] std::string drive(const rig::RigParameters& rig, const DriveProfile& profile);

}  // namespace study
