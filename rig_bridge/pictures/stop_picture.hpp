/// The picture of a stop, like the paper's Fig. 12: speeds, slip, pressures over time, drawn by gnuplot.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace pictures {

/// Sample of a stop.
struct StopRow {
    double time_s = 0.0;
    double speed_mps = 0.0;
    double wheel_rim_speed_mps = 0.0;
    double slip = 0.0;
    double slip_reference = 0.0;
    double demand_Pa = 0.0;
    double pressure_Pa = 0.0;

    /// On a runway: distance from touchdown, used friction, and friction available at this speed. Only with load on the wheel.
    struct Friction {
        double runway_m, mu, mu_max;
    };
    std::optional<Friction> friction = std::nullopt;
};

/// Draws the course of a stop into `png`; the vertical line marks `brake_on_s`. Also draws friction over the runway if the rows have it. Written
/// atomically. Throws std::runtime_error as run_gnuplot().
void draw_stop(std::span<const StopRow> course, const std::filesystem::path& png, const std::string& title, double brake_on_s);

}  // namespace pictures
