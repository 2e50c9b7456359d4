#include <fmt/format.h>

#include <iterator>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/study/validation/plant_validation.hpp"
#include "rig_bridge/pictures/figure.hpp"
#include "rig_bridge/pictures/gnuplot.hpp"

namespace validation {

namespace {

void append_errors(settings::TextTable& table, const std::string& title, const ValidationErrors& e) {
    table.add(title, e.speed_mps.count, e.speed_mps.rms(), e.speed_mps.largest, e.wheel_rim_mps.rms(), e.wheel_rim_mps.largest, e.slip.rms(),
              e.slip.largest);
}

settings::Json as_json(const ErrorFigures& e) {
    return {{"count", e.count}, {"rms", e.rms()}, {"max", e.largest}};
}

settings::Json as_json(const ValidationErrors& e) {
    return {{"speed_mps", as_json(e.speed_mps)}, {"wheel_rim_mps", as_json(e.wheel_rim_mps)}, {"slip", as_json(e.slip)}};
}

}  // namespace

std::string to_csv(const Validation& validation) {
    auto csv = settings::TextTable::csv(
        "time_s:.4f|speed_mps:.6g|simulated_speed_mps:.6g|wheel_rim_mps:.6g|simulated_wheel_rim_mps:.6g|slip:.6g|simulated_slip:.6g|pressure_Pa:.6g");
    for (const ValidationRow& r : validation.rows)
        csv.add(r.time_s, r.speed_mps, r.simulated_speed_mps, r.wheel_rim_mps, r.simulated_wheel_rim_mps, r.slip, r.simulated_slip, r.pressure_Pa);
    return csv.text();
}

std::string to_text(const Validation& v) {
    std::string text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "brake-on at {:.3f} s (line {}), {:.2f} m/s; compared for {:.2f} s, until: {}\n", v.brake_on_s, v.brake_on_line,
                   v.brake_on_mps, v.end_s, v.ended);
    text += "simulated minus recorded:\n";
    fmt::format_to(out, "{:<12}{:>7}{:>21}{:>21}{:>21}\n", "recorded", "", "speed, m/s", "wheel rim, m/s", "slip");
    auto table = settings::TextTable::screen("speed, m/s:<12|rows:>7|RMS:>11.4f|max:>10.4f|RMS:>11.4f|max:>10.4f|RMS:>11.5f|max:>10.5f");
    for (std::size_t i = v.bands.size(); i-- > 0;) {
        if (v.bands[i].speed_mps.count == 0) continue;
        const double from = static_cast<double>(i) * Validation::kBand_mps;
        append_errors(table, fmt::format("{:.0f} to {:.0f}", from, from + Validation::kBand_mps), v.bands[i]);
    }
    append_errors(table, "all", v.all);
    text += table.text();
    constexpr double kWorthSaying = 0.005;
    if (v.past_peak > kWorthSaying)
        fmt::format_to(
            out,
            "{:.0f} % of the rows have a slip beyond the peak of the friction curve ({:.3f}): the wheel is unstable there,\n  and feed-forward does "
            "not hold it where the recorded closed loop did; errors of wheel and slip are then no measure\n  of the model\n",
            100.0 * v.past_peak, v.peak_slip);
    if (v.gaps > 0) fmt::format_to(out, "{} gaps between samples, the longest {:.3f} s: pressure taken as linear across\n", v.gaps, v.longest_gap_s);
    if (v.rejected > 0) fmt::format_to(out, "{} frames failed a check and were not used\n", v.rejected);
    return text;
}

std::string to_json(const Validation& v, const std::string& head) {
    auto root = settings::parse_json(head);
    root["clock"] = v.lockstep ? "sync" : "stamps";
    root["brake_on_s"] = v.brake_on_s;
    root["brake_on_line"] = v.brake_on_line;
    root["brake_on_mps"] = v.brake_on_mps;
    root["compared_s"] = v.end_s;
    root["ended"] = v.ended;
    root["gaps"] = v.gaps;
    root["longest_gap_s"] = v.longest_gap_s;
    root["rejected_frames"] = v.rejected;
    root["peak_slip"] = v.peak_slip;
    root["past_peak_share"] = v.past_peak;
    auto bands = settings::Json::array();
    for (std::size_t i = 0; i < v.bands.size(); ++i) {
        const double from = static_cast<double>(i) * Validation::kBand_mps;
        auto band = as_json(v.bands[i]);
        band["from_mps"] = from;
        band["to_mps"] = from + Validation::kBand_mps;
        bands.push_back(band);
    }
    root["bands"] = bands;
    root["all"] = as_json(v.all);
    return settings::json_page(root);
}

void draw_validation(const Validation& validation, const std::filesystem::path& png, const std::string& title) {
    using pictures::Series;
    const auto curve = [&](const char* name, pictures::Colour colour, pictures::Style style, const auto& value) {
        Series s{.name = name, .style = style, .colour = colour};
        for (const ValidationRow& r : validation.rows) {
            const std::optional<double> y = value(r);
            s.add(r.time_s, y.value_or(std::numeric_limits<double>::quiet_NaN()));
        }
        return s;
    };
    const auto measured = [&](const char* name, pictures::Colour colour, const auto& value) {
        return curve(name, colour, pictures::Style::line, value);
    };
    const auto simulated = [&](const char* name, pictures::Colour colour, const auto& value) {
        return curve(name, colour, pictures::Style::dashes, value);
    };
    const auto chart = [](const char* label, std::vector<Series> series) {
        return pictures::Chart{.y_label = label, .x_label = "time since brake-on (s)", .series = std::move(series)};
    };
    using Row = ValidationRow;
    using Wheel = std::optional<double>;
    pictures::draw(
        {.title = title,
         .charts = {chart("speed (m/s)", {measured("aircraft, recorded", pictures::black, [](const Row& r) { return r.speed_mps; }),
                                          simulated("aircraft, simulated", pictures::orange, [](const Row& r) { return r.simulated_speed_mps; }),
                                          measured("wheel, recorded", pictures::blue, [](const Row& r) { return r.wheel_rim_mps; }),
                                          simulated("wheel, simulated", pictures::sky, [](const Row& r) { return r.simulated_wheel_rim_mps; })}),
                    chart("slip", {measured("recorded", pictures::blue, [](const Row& r) { return r.slip; }),
                                   simulated("simulated", pictures::orange, [](const Row& r) { return r.simulated_slip; })}),
                    chart("simulated - recorded (m/s)",
                          {measured("aircraft", pictures::black, [](const Row& r) { return r.simulated_speed_mps - r.speed_mps; }),
                           measured("wheel", pictures::sky,
                                    [](const Row& r) {
                                        return r.wheel_rim_mps && r.simulated_wheel_rim_mps ? Wheel(*r.simulated_wheel_rim_mps - *r.wheel_rim_mps)
                                                                                            : Wheel();
                                    })})}},
        png);
}

}  // namespace validation
