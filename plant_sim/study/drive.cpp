#include "plant_sim/study/drive.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string_view>

#include "firmware/host/settings/error.hpp"

namespace study {

namespace {

constexpr double kStep_s = 1e-3;
constexpr double kLongest_s = 3600.0;  // one row each ms: 3.6 million
// No brake and no valve of an aircraft comes near: beyond stands another unit, or a slip.
constexpr double kMost_Pa = 100e6;
constexpr double kMost_mA = 1000.0;

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

class Reader {
  public:
    explicit Reader(const std::filesystem::path& csv) : name_(csv.string()), in_(csv) {
        if (!in_) refuse("cannot be read");
    }

    DriveProfile read() {
        std::string line;
        DriveProfile profile;
        if (!next(line)) refuse("is empty; expected the header time_s,pressure_Pa or time_s,current_mA");
        profile.input = header(line);
        while (next(line)) row(line, profile);
        if (profile.time_s.size() < 2) refuse("needs two rows of numbers at least");
        if (profile.time_s.back() - profile.time_s.front() > kLongest_s)
            refuse(fmt::format("time_s: lasts longer than {:.0f} s", kLongest_s));
        return profile;
    }

  private:
    [[noreturn]] void refuse(const std::string& message) const {
        throw settings::Error(name_, line_, "", message);
    }

    bool next(std::string& line) {
        while (std::getline(in_, line)) {
            ++line_;
            if (!trimmed(line).empty()) return true;
        }
        return false;
    }

    [[nodiscard]] DriveInput header(std::string_view line) const {
        constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
        if (line.starts_with(kByteOrderMark)) line.remove_prefix(kByteOrderMark.size());
        const auto comma = line.find(',');
        const std::string_view first = trimmed(line.substr(0, comma));
        const std::string_view second =
            comma == std::string_view::npos ? "" : trimmed(line.substr(comma + 1));
        if (first == "time_s" && second == "pressure_Pa") return DriveInput::pressure_Pa;
        if (first == "time_s" && second == "current_mA") return DriveInput::current_mA;
        refuse("header '" + std::string(trimmed(line)) +
               "'; expected time_s,pressure_Pa or time_s,current_mA");
    }

    [[nodiscard]] double number(std::string_view text, const char* column) const {
        text = trimmed(text);
        double value = 0.0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
            refuse(std::string(column) + ": '" + std::string(text) + "' is no finite number");
        }
        return value;
    }

    void row(std::string_view line, DriveProfile& profile) const {
        const auto comma = line.find(',');
        if (comma == std::string_view::npos || line.find(',', comma + 1) != std::string_view::npos) {
            refuse("expected two columns");
        }
        const double time = number(line.substr(0, comma), "time_s");
        const char* column = profile.input == DriveInput::pressure_Pa ? "pressure_Pa" : "current_mA";
        const double value = number(line.substr(comma + 1), column);
        if (!profile.time_s.empty() && !(time > profile.time_s.back()))
            refuse("time_s must increase from row to row");
        const double most = profile.input == DriveInput::pressure_Pa ? kMost_Pa : kMost_mA;
        if (value < 0.0 || value > most) refuse(fmt::format("{} must be from 0 to {:g}", column, most));
        profile.time_s.push_back(time);
        profile.value.push_back(value);
    }

    std::string name_;
    std::ifstream in_;
    std::uint32_t line_ = 0;
};

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

    /// The time of the next row before `time_s`, else `time_s`.
    [[nodiscard]] double next_row_before(double time_s) const {
        const auto& t = profile_.time_s;
        return next_ < t.size() && t[next_] < time_s ? t[next_] : time_s;
    }

  private:
    const DriveProfile& profile_;
    std::size_t next_ = 0;
};

/// One step from `from_s` to `to_s`, cut where a row of the profile falls into it; returns the pressure at its end.
double advance_pressure(plant::Rig& rig, Cursor& cursor, double from_s, double to_s, double pressure_Pa,
                        std::vector<plant::Rig::PressurePart>& parts) {
    parts.clear();
    for (double at_s = from_s; at_s < to_s;) {
        const double next_s = cursor.next_row_before(to_s);
        const double next_Pa = cursor.at(next_s);
        parts.push_back({(next_s - at_s) / (to_s - from_s), pressure_Pa, next_Pa});
        at_s = next_s;
        pressure_Pa = next_Pa;
    }
    rig.advance_pressure(parts);
    return pressure_Pa;
}

void append_row(std::string& csv, double time_s, const plant::Rig& rig) {
    const plant::WheelState& w = rig.wheel();
    const plant::Forces f = rig.forces();
    fmt::format_to(std::back_inserter(csv),
                   "{:.6f},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n",
                   time_s, w.v_mps, w.omega_radps, f.slip, rig.pressure_Pa(), f.brake_torque_Nm, f.F_x_N,
                   f.F_z_N, f.radius_m, f.mu, w.energy_brake_J, w.energy_tyre_J);
}

}  // namespace

DriveProfile read_profile(const std::filesystem::path& csv) {
    return Reader(csv).read();
}

std::string drive(const plant::RigParameters& parameters, const DriveProfile& profile) {
    plant::Rig rig(parameters, kStep_s, 0);
    rig.start_rolling();
    Cursor cursor(profile);
    const double start = profile.time_s.front();
    const double end = profile.time_s.back();
    double value = cursor.at(start);
    if (profile.input == DriveInput::pressure_Pa) rig.start_pressure(value);
    std::string csv =
        "time_s,speed_mps,wheel_speed_radps,slip,pressure_Pa,brake_torque_Nm,F_x_N,F_z_N,radius_m,mu,energy_"
        "brake_J,energy_tyre_J\n";
    append_row(csv, start, rig);
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
        append_row(csv, time, rig);
    }
    return csv;
}

}  // namespace study
