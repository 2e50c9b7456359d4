/// The plant held against a recording, Section III.C and Fig. 5: measured brake pressure in feed-forward from brake-on, recorded
/// speed as start; simulated against recorded aircraft (rim) speed, wheel speed and slip.
///
/// Both sides are means over the same windows of about 10 ms between edges of the encoders, so that no estimator's lag enters.
/// Recorded wheel speed and slip use the simulated rolling radius r(F_z).
///
/// Beyond the peak of the friction curve the wheel is unstable (the pole of eq. 15): there the closed loop that was recorded held
/// it, feed-forward cannot, and the simulated wheel departs whatever the model is worth. `past_peak` says how much of the
/// recording lies there.
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
    double largest = 0.0;  ///< magnitude

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

    bool braked = false;      ///< false: no brake-on in the log, nothing else is set
    double brake_on_s = 0.0;  ///< since the first sample
    std::uint64_t brake_on_line = 0;
    double brake_on_mps = 0.0;
    double end_s = 0.0;  ///< since brake-on
    std::string ended;   ///< why: "standstill", ...
    bool lockstep = false;
    std::uint64_t gaps = 0;  ///< more than kGap_s between two samples while braking: pressure linear across
    double longest_gap_s = 0.0;
    std::uint64_t rejected = 0;           ///< frames that failed a check
    double peak_slip = 0.0;               ///< of the surface
    double past_peak = 0.0;               ///< share of the rows with recorded slip above it
    std::vector<ValidationErrors> bands;  ///< by recorded speed: [0, 10), [10, 20) ... m/s
    ValidationErrors all;
    std::vector<ValidationRow> rows;
};

[[nodiscard]] Validation validate_plant(rig::replay::MeasuredSignals& signals, const rig::RigParameters& rig);

/// time_s,speed_mps,simulated_speed_mps,wheel_rim_mps,simulated_wheel_rim_mps,slip,simulated_slip,pressure_Pa; a cell without a
/// value is empty.
[[nodiscard]] std::string to_csv(const Validation& validation);
[[nodiscard]] std::string to_text(const Validation& validation);
/// `head`: keys of the caller's own, put first; a JSON object as text.
[[nodiscard]] std::string to_json(const Validation& validation, const std::string& head);
/// Into `png`. Throws std::runtime_error when gnuplot is missing or fails.
void draw_validation(const Validation& validation, const std::filesystem::path& png, const std::string& title);

}  // namespace validation
