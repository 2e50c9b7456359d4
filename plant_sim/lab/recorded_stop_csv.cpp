#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "firmware/host/settings/near_miss.hpp"
#include "plant_sim/lab/recorded_stops.hpp"
#include "rig_bridge/wear/csv_rows.hpp"

namespace plant_sim::lab {

namespace {

using settings::Error;

constexpr std::array<std::string_view, 4> kColumns{"time_s", "speed_mps", "pressure_Pa", "brake_torque_Nm"};

using Places = std::array<std::size_t, kColumns.size()>;

Places places_of(const std::vector<std::string_view>& header, const std::string& name, unsigned line) {
    Places places{};
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
        const auto at = std::find(header.begin(), header.end(), kColumns[i]);
        if (at == header.end())
            throw Error(name, line, std::string(kColumns[i]),
                        "no such column; a recorded stop needs time_s, speed_mps, pressure_Pa, "
                        "brake_torque_Nm, named with these units");
        places[i] = static_cast<std::size_t>(at - header.begin());
    }
    return places;
}

double brake_on_mps(const wear::RecordedStop& stop) {
    constexpr double kShare = 0.02;
    double greatest_Pa = 0.0;
    for (const wear::BrakeSample& s : stop.samples) greatest_Pa = std::max(greatest_Pa, s.pressure_Pa);
    if (!(greatest_Pa > 0.0)) throw Error(stop.source, 0, "pressure_Pa", "no pressure in any row: no stop is in it");
    double before = stop.samples.front().speed_mps;
    for (const wear::BrakeSample& s : stop.samples) {
        if (s.pressure_Pa > kShare * greatest_Pa) break;
        before = s.speed_mps;
    }
    return before;
}

}  // namespace

wear::RecordedStop parse_stop(const std::string& name, std::string_view csv, double brake_gain_m3) {
    wear::RecordedStop stop{name, 0.0, brake_gain_m3, {}};
    std::vector<std::string_view> header;
    Places places{};
    for (wear::CsvRows rows(csv); rows.next();) {
        const unsigned line = rows.line();
        const std::vector<std::string_view>& fields = rows.fields();
        if (header.empty()) {
            header = fields;
            places = places_of(header, name, line);
            continue;
        }
        if (fields.size() != header.size()) throw Error(name, line, "", fmt::format("has {} fields, the header {}", fields.size(), header.size()));
        std::array<double, kColumns.size()> values{};
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = wear::csv_number(name, line, kColumns[i], fields[places[i]]);
        if (!stop.samples.empty() && values[0] < stop.samples.back().time_s)
            throw Error(name, line, "time_s", fmt::format("{} is before the row ahead of it", values[0]));
        stop.samples.push_back({values[0], values[1], values[2], values[3]});
    }
    if (header.empty()) throw Error(name, 0, "", "empty: no header and no row");
    if (stop.samples.empty()) throw Error(name, 0, "", "no row after the header");
    stop.brake_on_mps = brake_on_mps(stop);
    return stop;
}

}  // namespace plant_sim::lab
