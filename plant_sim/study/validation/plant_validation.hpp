/// Compares the plant with a recording as in Section III.C and Fig. 5: the measured brake pressure is fed forward from brake-on, starting at the
/// recorded speed; compared are aircraft (rim) speed, wheel speed and slip.
///
/// Both sides are means over the same windows of about 10 ms between edges of the encoders, so that no estimator's lag matters. Recorded wheel speed
/// and slip use the simulated rolling radius r(F_z).
///
/// Beyond the peak of the friction curve the wheel is unstable (the pole of eq. 15). There the recorded wheel was held by its closed loop; with
/// feed-forward the simulated wheel departs even if the model is exact. `past_peak` is the share of the recording in that range.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "plant_sim/model/rig.hpp"
#include "rig_bridge/replay/measured_signals.hpp"

namespace validation {

/// Simulated minus recorded.
struct ErrorFigures {
    std::uint64_t count = 0;
    double sum_of_squares = 0.0;
    double largest = 0.0;  ///< absolute value

    void add(double error);
    [[nodiscard]] double rms() const;
};

struct ValidationErrors {
    ErrorFigures speed_mps;
    ErrorFigures wheel_rim_mps;
    ErrorFigures slip;
};

struct ValidationRow {
    double time_s = 0.0;  ///< since brake-on
    double speed_mps = 0.0, simulated_speed_mps = 0.0;
    std::optional<double> wheel_rim_mps, simulated_wheel_rim_mps, slip, simulated_slip;
    double pressure_Pa = 0.0;
};

struct Validation {
    static constexpr double kBand_mps = 10.0;

    bool braked = false;      ///< false: the log has no brake-on, and no other member is set
    double brake_on_s = 0.0;  ///< from the first sample
    std::uint64_t brake_on_line = 0;
    double brake_on_mps = 0.0;
    double end_s = 0.0;  ///< since brake-on
    std::string ended;   ///< reason: "standstill", ...
    bool lockstep = false;
    std::uint64_t gaps = 0;  ///< number of intervals above kGap_s between samples while braking; pressure is interpolated linearly
    double longest_gap_s = 0.0;
    std::uint64_t rejected = 0;           ///< frames that failed a check
    double peak_slip = 0.0;               ///< of the surface
    double past_peak = 0.0;               ///< share of the rows whose recorded slip is above `peak_slip`
    std::vector<ValidationErrors> bands;  ///< by recorded speed: [0, 10), [10, 20) ... m/s
    ValidationErrors all;
    std::vector<ValidationRow> rows;
};

[[nodiscard]] Validation validate_plant(rig::replay::MeasuredSignals& signals, const rig::RigParameters& rig);

/// Columns time_s, speed_mps, simulated_speed_mps, wheel_rim_mps, simulated_wheel_rim_mps, slip, simulated_slip, pressure_Pa; a missing value is an
/// empty cell.
[[nodiscard]] std::string to_csv(const Validation& validation);
[[nodiscard]] std::string to_text(const Validation& validation);
/// `head`: a JSON object as text, whose keys come first.
[[nodiscard]] std::string to_json(const Validation& validation, const std::string& head);
/// Writes `png`. Throws std::runtime_error if gnuplot is missing or fails.
void draw_validation(const Validation& validation, const std::filesystem::path& png, const std::string& title);

}  // namespace validation
