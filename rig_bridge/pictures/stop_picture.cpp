#include "rig_bridge/pictures/stop_picture.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "rig_bridge/pictures/figure.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"

namespace pictures {

void draw_stop(std::span<const StopRow> course, const std::filesystem::path& png, const std::string& title, double brake_on_s) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    constexpr double kStanding_mps = 0.1;
    const auto curve = [&](const char* name, Colour colour, auto value) {
        Series s{.name = name, .colour = colour};
        for (const StopRow& row : course) s.add(row.time_s, value(row));
        return s;
    };
    Figure figure{.title = title};
    const auto chart = [&](const char* label, std::vector<Series> series, std::optional<Range> range) {
        figure.charts.push_back({.y_label = label, .x_label = "time (s)", .series = std::move(series), .y_range = range, .marks = {brake_on_s}});
    };
    chart("speed (m/s)",
          {curve("aircraft", blue, [](const StopRow& r) { return r.speed_mps; }),
           curve("wheel", vermillion, [](const StopRow& r) { return r.wheel_rim_speed_mps; })},
          {});
    chart("slip",
          {curve("slip", vermillion, [](const StopRow& r) { return r.speed_mps > kStanding_mps ? r.slip : kNone; }),
           curve("reference in force", blue, [](const StopRow& r) { return r.slip_reference > 0.0 ? r.slip_reference : kNone; })},
          Range{-0.1, 1.05});
    chart("brake pressure (MPa)",
          {curve("requested by the pilot", blue, [](const StopRow& r) { return r.demand_Pa * 1e-6; }),
           curve("applied", vermillion, [](const StopRow& r) { return r.pressure_Pa * 1e-6; })},
          {});
    if (std::ranges::any_of(course, [](const StopRow& r) { return r.friction.has_value(); })) {
        Series available{.name = "available at this speed", .colour = blue};
        Series used{.name = "used", .colour = vermillion};
        for (const StopRow& row : course) {
            if (!row.friction) continue;
            available.add(row.friction->runway_m, row.friction->mu_max);
            used.add(row.friction->runway_m, row.friction->mu);
        }
        figure.charts.push_back({.y_label = "friction", .x_label = "on the runway, from touchdown (m)", .series = {available, used}});
    }
    draw(std::move(figure), png);
}

}  // namespace pictures
