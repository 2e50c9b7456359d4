#include "plant_sim/study/drive.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <string_view>

#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/input_file.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "rig_bridge/wear/csv_rows.hpp"

namespace study {

namespace {

constexpr double kStep_s = 1e-3;
constexpr double kLongest_s = 3600.0;  // one row each ms: 3.6 million
constexpr std::size_t kMaxBytes = 512U << 20U;
// No brake or valve of an aircraft comes near: a larger value has another unit or is a mistake.
constexpr double kMax_Pa = 100e6;
constexpr double kMax_mA = 1000.0;

void append(DriveProfile& profile, const std::string& name, unsigned line, double time_s, double value) {
    const bool by_pressure = profile.input == DriveInput::pressure_Pa;
    const double max = by_pressure ? kMax_Pa : kMax_mA;
    if (!std::isfinite(time_s) || (!profile.time_s.empty() && !(time_s > profile.time_s.back())))
        throw settings::Error(name, line, "", "time_s must increase from row to row");
    if (!(value >= 0.0 && value <= max))
        throw settings::Error(name, line, "", fmt::format("{} must be from 0 to {:g}", by_pressure ? "pressure_Pa" : "current_mA", max));
    profile.time_s.push_back(time_s);
    profile.value.push_back(value);
}

void check_length(const DriveProfile& profile, const std::string& name, unsigned line) {
    if (profile.time_s.size() < 2) throw settings::Error(name, line, "", "needs two rows of numbers at least");
    if (profile.time_s.back() - profile.time_s.front() > kLongest_s)
        throw settings::Error(name, line, "", fmt::format("time_s: lasts longer than {:.0f} s", kLongest_s));
}

DriveProfile parse(const std::string& name, std::string_view csv) {
    const auto reject = [&name](unsigned line, const std::string& message) { throw settings::Error(name, line, "", message); };
    wear::CsvRows rows(csv);
    if (!rows.next()) reject(rows.line(), "is empty; expected the header time_s,pressure_Pa or time_s,current_mA");
    const std::vector<std::string_view> header = rows.fields();
    const bool by_pressure = header.back() == "pressure_Pa";
    if (header.size() != 2 || header.front() != "time_s" || (!by_pressure && header.back() != "current_mA"))
        reject(rows.line(), fmt::format("header '{}'; expected time_s,pressure_Pa or time_s,current_mA", fmt::join(header, ",")));
    DriveProfile profile;
    profile.input = by_pressure ? DriveInput::pressure_Pa : DriveInput::current_mA;
    while (rows.next()) {
        const unsigned line = rows.line();
        if (rows.fields().size() != 2) reject(line, "expected two columns");
        const double time_s = wear::csv_number(name, line, "time_s", rows.fields().front());
        append(profile, name, line, time_s, wear::csv_number(name, line, header.back(), rows.fields().back()));
    }
    check_length(profile, name, rows.line());
    return profile;
}

/// Walks forward through a profile.
class Cursor {
  public:
    explicit Cursor(const DriveProfile& profile) : profile_(profile) {}

    double at(double time_s) {
        const auto& t = profile_.time_s;
        while (next_ < t.size() && t[next_] <= time_s) ++next_;
        if (next_ == 0) return profile_.value.front();
        if (next_ == t.size()) return profile_.value.back();
        const double share = (time_s - t[next_ - 1]) / (t[next_] - t[next_ - 1]);
        return profile_.value[next_ - 1] + share * (profile_.value[next_] - profile_.value[next_ - 1]);
    }

    /// Time of the next row before `time_s`; if there is none, `time_s`.
    [[nodiscard]] double next_row_before(double time_s) const {
        const auto& t = profile_.time_s;
        return next_ < t.size() && t[next_] < time_s - kRounding_s ? t[next_] : time_s;
    }

    /// Value just before `time_s`. Rows at the same time, but for rounding, count as one; the first is used.
    double right_before(double time_s) {
        const auto& t = profile_.time_s;
        return next_ < t.size() && std::abs(t[next_] - time_s) <= kRounding_s ? profile_.value[next_] : at(time_s);
    }

    /// Value just after `time_s`, where it was `value`; passes the rows of that time.
    double right_after(double time_s, double value) {
        const auto& t = profile_.time_s;
        for (; next_ < t.size() && t[next_] <= time_s + kRounding_s; ++next_) value = profile_.value[next_];
        return value;
    }

  private:
    // Rounding of summed times. A shorter piece would give meaningless rates.
    static constexpr double kRounding_s = 1e-9;

    const DriveProfile& profile_;
    std::size_t next_ = 0;
};

/// One step from `from_s` to `to_s`, cut where a row of the profile falls into it; returns the pressure at its end.
double advance_pressure(plant::Rig& rig, Cursor& cursor, double from_s, double to_s, double pressure_Pa,
                        std::vector<plant::Rig::PressurePart>& parts) {
    parts.clear();
    for (double at_s = from_s; at_s < to_s;) {
        pressure_Pa = cursor.right_after(at_s, pressure_Pa);
        const double next_s = cursor.next_row_before(to_s);
        const double next_Pa = cursor.right_before(next_s);
        parts.push_back({(next_s - at_s) / (to_s - from_s), pressure_Pa, next_Pa});
        at_s = next_s;
        pressure_Pa = next_Pa;
    }
    rig.advance_pressure(parts);
    return pressure_Pa;
}

DriveRow row_of(double time_s, const plant::Rig& rig) {
    const plant::WheelState& w = rig.wheel();
    const plant::Forces f = rig.forces();
    return {time_s,  w.v_mps, w.omega_radps, f.slip, rig.pressure_Pa(), f.brake_torque_Nm,
            f.F_x_N, f.F_z_N, f.radius_m,    f.mu,   w.energy_brake_J,  w.energy_tyre_J};
}

}  // namespace

DriveProfile read_profile(const std::filesystem::path& csv) {
    return parse(csv.string(), settings::read_file(csv, kMaxBytes));
}

DriveProfile profile_of(const std::string& name, DriveInput input, std::span<const double> time_s, std::span<const double> value) {
    if (time_s.size() != value.size())
        throw settings::Error(name, 0, "", fmt::format("{} times and {} values: expected one of each a row", time_s.size(), value.size()));
    DriveProfile profile;
    profile.input = input;
    for (std::size_t i = 0; i < time_s.size(); ++i) append(profile, name, static_cast<unsigned>(i + 1), time_s[i], value[i]);
    check_length(profile, name, static_cast<unsigned>(time_s.size()));
    return profile;
}

void drive(const rig::RigParameters& parameters, const DriveProfile& profile, const std::function<void(const DriveRow&)>& on_row) {
    plant::Rig rig(parameters, kStep_s, 0);
    rig.start_rolling();
    Cursor cursor(profile);
    const double start = profile.time_s.front();
    const double end = profile.time_s.back();
    double value = cursor.at(start);
    if (profile.input == DriveInput::pressure_Pa) rig.start_pressure(value);
    on_row(row_of(start, rig));
    std::vector<plant::Rig::PressurePart> parts;
    for (std::int64_t step = 1; !rig.standstill(); ++step) {
        const double time = start + static_cast<double>(step) * kStep_s;
        if (time > end + 0.5 * kStep_s) break;
        if (profile.input == DriveInput::pressure_Pa) {
            value = advance_pressure(rig, cursor, time - kStep_s, time, value, parts);
        } else {
            const double next = cursor.at(time);
            rig.advance_current(value, next);
            value = next;
        }
        on_row(row_of(time, rig));
    }
}

std::string drive(const rig::RigParameters& rig, const DriveProfile& profile) {
    std::string columns = "time_s:.6f";
    for (std::size_t i = 1; i < kDriveColumns.size(); ++i) columns += fmt::format("|{}:.9g", kDriveColumns.at(i));
    auto csv = settings::TextTable::csv(columns);
    drive(rig, profile, [&csv](const DriveRow& row) {
        for (const double value : row) csv.add(value);
    });
    return csv.text();
}

}  // namespace study
