#include "rig_bridge/pictures/stop_picture.hpp"

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "rig_bridge/pictures/figure.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"

namespace pictures {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// A table's numbers by the names of its columns; what is no number is not a number.
class Columns {
  public:
    explicit Columns(std::string_view csv) {
        std::vector<std::string> names = fields(csv);
        for (rows_ = 0; !csv.empty(); ++rows_) {
            const std::vector<std::string> row = fields(csv);
            for (std::size_t i = 0; i < names.size() && i < row.size(); ++i) {
                char* end = nullptr;
                const double value = std::strtod(row[i].c_str(), &end);
                values_[names[i]].push_back(end == row[i].c_str() ? kNone : value);
            }
        }
    }

    /// Column `y` over column `x`, times `scale`, where `when` is above `floor`.
    [[nodiscard]] Series over(const char* x, const char* y, const char* name, Colour colour, const char* when, double floor,
                              double scale = 1.0) const {
        Series s{.name = name, .colour = colour};
        for (std::size_t i = 0; i < rows_; ++i) s.add(at(x, i), at(when, i) > floor ? at(y, i) * scale : kNone);
        return s;
    }

  private:
    static std::vector<std::string> fields(std::string_view& csv) {
        std::string_view line = csv.substr(0, csv.find('\n'));
        csv.remove_prefix(std::min(csv.size(), line.size() + 1));
        std::vector<std::string> all;
        for (std::size_t from = 0; from <= line.size(); from += all.back().size() + 1)
            all.emplace_back(line.substr(from, line.find(',', from) - from));
        return all;
    }

    [[nodiscard]] double at(const char* column, std::size_t row) const { return values_.at(column).at(row); }

    std::map<std::string, std::vector<double>, std::less<>> values_;
    std::size_t rows_ = 0;
};

}  // namespace

void draw_stop(std::string_view csv, const std::filesystem::path& png, const std::string& title, double brake_on_s, bool along_runway) {
    const Columns table(csv);
    constexpr double kAlways = -1e300;
    constexpr double kStanding_mps = 0.1;
    const auto curve = [&](const char* y, const char* name, Colour colour, double scale = 1.0) {
        return table.over("time_s", y, name, colour, "time_s", kAlways, scale);
    };
    Figure figure{.title = title};
    const auto chart = [&](const char* label, std::vector<Series> series, std::optional<Range> range) {
        figure.charts.push_back({.y_label = label, .x_label = "time (s)", .series = std::move(series), .y_range = range, .marks = {brake_on_s}});
    };
    chart("speed (m/s)", {curve("speed_mps", "aircraft", blue), curve("wheel_rim_speed_mps", "wheel", vermillion)}, {});
    chart("slip",
          {table.over("time_s", "slip", "slip", vermillion, "speed_mps", kStanding_mps),
           table.over("time_s", "slip_reference", "reference in force", blue, "slip_reference", 0.0)},
          Range{-0.1, 1.05});
    chart("brake pressure (MPa)",
          {curve("pressure_demand_Pa", "requested by the pilot", blue, 1e-6), curve("pressure_Pa", "applied", vermillion, 1e-6)}, {});
    if (along_runway)
        figure.charts.push_back({.y_label = "friction",
                                 .x_label = "on the runway, from touchdown (m)",
                                 .series = {table.over("runway_m", "mu_max", "available at this speed", blue, "F_z_N", 0.0),
                                            table.over("runway_m", "mu", "used", vermillion, "F_z_N", 0.0)}});
    draw(std::move(figure), png);
}

}  // namespace pictures
