/// The picture of a stop, like the paper's Fig. 12: speeds, slip, pressures over time, drawn by gnuplot.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace pictures {

/// A moment of a stop.
struct StopRow {
    double time_s = 0.0;
    double speed_mps = 0.0;
    double wheel_rim_speed_mps = 0.0;
    double slip = 0.0;
    double slip_reference = 0.0;
    double demand_Pa = 0.0;
    double pressure_Pa = 0.0;

    /// On the runway: metres from touchdown, friction that is used and that is available at this speed. With load on the wheel alone.
    struct Friction {
        double runway_m, mu, mu_max;
    };
    std::optional<Friction> friction = std::nullopt;
};

/// Draws the course of a stop into `png`; the vertical line marks `brake_on_s`. Where rows have it, also friction over the runway. The picture is
/// whole or not there. Throws std::runtime_error when gnuplot is not installed or fails, with what it said.
void draw_stop(std::span<const StopRow> course, const std::filesystem::path& png, const std::string& title, double brake_on_s);

}  // namespace pictures
