#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <initializer_list>
#include <iterator>

#include "firmware/host/settings/atomic_file.hpp"
#include "plant_sim/study/identification/identified.hpp"

namespace identification {

namespace {

namespace fs = std::filesystem;

/// A TOML file whose values are replaced in place, so that comments and order are kept. It must have the form of the shipped files: `[table]` and
/// `key = value` on separate lines; an array may have several lines.
class EditedToml {
  public:
    explicit EditedToml(fs::path file) : file_(std::move(file)) {
        std::ifstream in(file_);
        if (!in) throw settings::Error(file_.string(), 0, "", "cannot be read");
        for (std::string line; std::getline(in, line);) lines_.push_back(line);
    }

    /// `optional`: a missing key is added.
    void set(const std::string& table, const std::string& key, const std::string& value, const std::string& note, bool optional = false) {
        const std::size_t head = header(table);
        const std::string line = fmt::format("{} = {}  # identified{}", key, value, note);
        for (std::size_t i = head + 1; i < lines_.size() && !lines_[i].starts_with('['); ++i) {
            if (!is_key(lines_[i], key)) continue;
            std::size_t end = i;
            while (opens(lines_[i]) && lines_[end].find(']') == std::string::npos && end + 1 < lines_.size()) ++end;
            lines_.erase(lines_.begin() + static_cast<std::ptrdiff_t>(i) + 1, lines_.begin() + static_cast<std::ptrdiff_t>(end) + 1);
            lines_[i] = line;
            return;
        }
        if (!optional) throw settings::Error(file_.string(), static_cast<std::uint32_t>(head + 1), table + "." + key, "is missing");
        lines_.insert(lines_.begin() + static_cast<std::ptrdiff_t>(head) + 1, line);
    }
    /// Removes a key of one line, if it is there.
    void remove(const std::string& table, const std::string& key) {
        for (std::size_t i = header(table) + 1; i < lines_.size() && !lines_[i].starts_with('['); ++i)
            if (is_key(lines_[i], key)) lines_.erase(lines_.begin() + static_cast<std::ptrdiff_t>(i--));
    }
    [[nodiscard]] bool has(const std::string& table) const { return find(table) < lines_.size(); }
    /// Whether the file has the key.
    [[nodiscard]] bool has(const std::string& table, const std::string& key) const {
        if (!has(table)) return false;
        for (std::size_t i = header(table) + 1; i < lines_.size() && !lines_[i].starts_with('['); ++i) {
            if (is_key(lines_[i], key)) return true;
        }
        return false;
    }
    /// Appends a table with these lines.
    void append(const std::string& table, std::initializer_list<const char*> lines) {
        lines_.insert(lines_.end(), {"", "[" + table + "]"});
        lines_.insert(lines_.end(), lines.begin(), lines.end());
    }
    void set(const std::string& table, const std::string& key, const Estimate& e, double factor = 1.0, bool optional = false) {
        set(table, key, fmt::format("{:.8g}", e.value * factor), fmt::format(", 95 %: {:.6g} to {:.6g}", e.low * factor, e.high * factor), optional);
    }
    void write() const { settings::write_file(file_, fmt::format("{}\n", fmt::join(lines_, "\n"))); }

  private:
    /// The line of the table's header; behind the last if there is none.
    [[nodiscard]] std::size_t find(const std::string& table) const {
        const auto at = std::ranges::find_if(lines_, [head = "[" + table + "]"](const std::string& line) { return line.starts_with(head); });
        return static_cast<std::size_t>(at - lines_.begin());
    }
    [[nodiscard]] std::size_t header(const std::string& table) const {
        if (!has(table)) throw settings::Error(file_.string(), 0, table, "is missing");
        return find(table);
    }
    [[nodiscard]] static bool is_key(const std::string& line, const std::string& key) {
        if (!line.starts_with(key)) return false;
        const std::size_t next = line.find_first_not_of(' ', key.size());
        return next != std::string::npos && line[next] == '=';
    }
    [[nodiscard]] static bool opens(const std::string& line) {
        const std::size_t value = line.find_first_not_of(' ', line.find('=') + 1);
        return value != std::string::npos && line[value] == '[';
    }

    fs::path file_;
    std::vector<std::string> lines_;
};

/// The same text for the same pressure: the controller's full pressure must not exceed the last point of its map, not even by rounding.
std::string pascals(double pressure_Pa) {
    return fmt::format("{:.7g}", pressure_Pa);
}

/// Sets the keys that the files of plant and controller have in common.
void set_valve(EditedToml& file, const ValveFit& v) {
    std::vector<std::string> current{fmt::format("{:.6g}", v.dead_zone_mA.value)};
    std::vector<std::string> pressure{"0.0"};
    current.reserve(v.current_mA.size() + 1);
    pressure.reserve(v.current_mA.size() + 1);
    for (std::size_t i = 0; i < v.current_mA.size(); ++i) {
        current.push_back(fmt::format("{:.6g}", v.current_mA[i]));
        pressure.push_back(pascals(v.pressure_Pa[i].value));
    }
    file.set("valve", "current_mA", fmt::format("[{}]", fmt::join(current, ", ")), "");
    file.set("valve", "pressure_Pa", fmt::format("[{}]", fmt::join(pressure, ", ")), "");
    file.set("valve", "natural_frequency_Hz", v.natural_frequency_Hz);
    file.set("valve", "damping", v.damping);
    file.set("valve", "delay_ms", v.delay_s, 1e3);
}

}  // namespace

void write_config(const Identified& found, const ConfigFiles& files, const fs::path& from, const fs::path& to) {
    if (fs::exists(to)) throw settings::Error(to.string(), 0, "", "exists already; a configuration that was identified gets a directory of its own");
    fs::create_directories(to.parent_path());
    fs::copy(from, to, fs::copy_options::recursive);
    EditedToml plant(to / files.rig);
    EditedToml controller(to / files.controller);
    const ValveFit& v = found.valve;
    set_valve(plant, v);
    set_valve(controller, v);
    const Estimate& full_Pa = v.pressure_Pa.back();
    controller.set("valve", "full_pressure_Pa", pascals(full_Pa.value), fmt::format(", 95 %: {:.6g} to {:.6g}", full_Pa.low, full_Pa.high));
    // A hysteresis or line that the file assumed is not what the recordings show: the gauge is at the brake, so frequency and delay contain the line.
    if (v.hysteresis_mA.low > 0.0 || plant.has("valve", "hysteresis_mA")) {
        const double width_mA = v.hysteresis_mA.low > 0.0 ? v.hysteresis_mA.value : 0.0;
        plant.set("valve", "hysteresis_mA", fmt::format("{:.6g}", width_mA),
                  fmt::format(", 95 %: {:.6g} to {:.6g}", v.hysteresis_mA.low, v.hysteresis_mA.high), true);
    }
    if (plant.has("valve", "line_ms")) plant.set("valve", "line_ms", "0.0", ": the dynamics above contain it");
    if (found.wheel) {
        const WheelFit& w = *found.wheel;
        plant.set("wheel", "inertia_kgm2", w.inertia_kgm2);
        plant.set("brake", "friction", w.friction);
        const bool clamps = w.contact_Pa.has_value() || w.piston_friction.has_value();
        if (clamps && !plant.has("brake.clamping"))
            plant.append("brake.clamping", {"contact_Pa = 0.0", "piston_friction = 0.0", "run_out = 0.0", "warp = 0.0"});
        if (plant.has("brake.clamping")) {
            plant.set("brake.clamping", "contact_Pa", w.contact_Pa.value_or(Estimate{}));
            plant.set("brake.clamping", "piston_friction", w.piston_friction.value_or(Estimate{}));
        }
        std::vector<std::string> relative;
        relative.reserve(w.relative_friction.size());
        for (const Estimate& e : w.relative_friction) relative.push_back(fmt::format("{:.7g}", e.value));
        plant.set("brake.relative_friction", w.friction_class, fmt::format("[{}]", fmt::join(relative, ", ")), "");
        controller.set("wheel", "inertia_kgm2", w.inertia_kgm2);
        controller.set("wheel", "brake_gain_m3", w.gain_m3);
    }
    plant.write();
    controller.write();
    EditedToml surfaces(to / "surfaces.toml");
    for (const FrictionFit& f : found.surfaces) {
        const std::string table = "surfaces." + f.surface;
        for (const char* key : {"c1", "c2", "c3", "magic_formula"}) surfaces.remove(table, key);
        if (f.curve.magic) {
            std::vector<std::string> values, intervals;
            for (const Coefficient& c : f.coefficients) {
                values.push_back(fmt::format("{} = {:.8g}", c.name, c.estimate.value));
                intervals.push_back(fmt::format("{} {:.6g} to {:.6g}", c.name, c.estimate.low, c.estimate.high));
            }
            surfaces.set(table, "magic_formula", fmt::format("{{ {} }}", fmt::join(values, ", ")),
                         fmt::format(", 95 %: {}", fmt::join(intervals, ", ")), true);
        } else {
            const std::vector<Coefficient> last_first(f.coefficients.rbegin(), f.coefficients.rend());  // each is put first
            for (const Coefficient& c : last_first) surfaces.set(table, c.name, c.estimate, 1.0, true);
        }
    }
    surfaces.write();
}

}  // namespace identification
