#include "plant_sim/lab/recorded_stops.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <numbers>

#include "firmware/host/layout_files.hpp"
#include "firmware/host/seconds.hpp"
#include "firmware/host/settings/input_file.hpp"
#include "firmware/host/settings/near_miss.hpp"
#include "rig_bridge/record/bus_meter.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "rig_bridge/replay/log_meter.hpp"
#include "rig_bridge/replay/log_reader.hpp"
#include "rig_bridge/rig/load_rig.hpp"
#include "rig_bridge/rig/meter_parameters.hpp"
#include "rig_bridge/rig/scenario.hpp"
#include "rig_bridge/wear/csv_rows.hpp"

namespace plant_sim::lab {

using antiskid::host::seconds;

namespace {

namespace fs = std::filesystem;
using antiskid::can::Time;
using settings::Error;

bool contains(const std::vector<std::string>& all, const std::string& one) {
    return std::find(all.begin(), all.end(), one) != all.end();
}

std::string listed(const std::vector<std::string>& names) {
    return fmt::format("{}", fmt::join(names, ", "));
}

/// Folders with a log in them, at most two levels below a ledger's directory: CAMPAIGN/0001.
std::vector<fs::path> maneuvers_below(const fs::path& directory, int levels) {
    std::vector<fs::path> found;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory)) {
        if (!entry.is_directory()) continue;
        if (!rig::replay::log_in(entry.path()).empty()) {
            found.push_back(entry.path());
        } else if (levels > 1) {
            const std::vector<fs::path> deeper = maneuvers_below(entry.path(), levels - 1);
            found.insert(found.end(), deeper.begin(), deeper.end());
        }
    }
    std::sort(found.begin(), found.end());
    return found;
}

bool is_csv(const fs::path& file) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return ending == ".csv";
}

/// Beyond this slip the wheel stands, and a held disc shows no friction.
constexpr double kStands = 0.9;

/// The road's way by edges or, where the sensor reports that, by its speed.
class RoadWay {
  public:
    explicit RoadWay(const rig::RigParameters& r)
        : radius_m_(r.flywheel_radius_m), track_(2.0 * std::numbers::pi / r.flywheel_encoder.teeth * r.flywheel_radius_m) {}

    void update(const antiskid::control::SpeedInput& input, Time now) {
        if (input.received == antiskid::control::kNever) return;
        edges_ = input.source == antiskid::control::SpeedSource::edges;
        if (edges_) {
            track_.update(input.edge_count, input.edge_time, seconds(now));
            return;
        }
        if (known_) integrated_m_ += speed_mps_ * (seconds(now) - now_s_);
        known_ = true;
        now_s_ = seconds(now);
        speed_mps_ = static_cast<double>(input.speed_radps) * radius_m_;
    }
    [[nodiscard]] double way_m(double now_s) const { return edges_ ? track_.way(now_s) : integrated_m_; }

  private:
    double radius_m_;
    rig::record::EdgeTrack track_;
    bool edges_ = true;
    bool known_ = false;
    double integrated_m_ = 0.0, now_s_ = 0.0, speed_mps_ = 0.0;
};

struct Raw {
    double time_s, way_m, pressure_Pa, torque_Nm;
    bool stands;
};

/// With the mean speed between the neighbours of each row: a speed measured over the newest edges would lag behind the torque.
std::vector<wear::BrakeSample> samples_of(const std::vector<Raw>& rows) {
    std::vector<wear::BrakeSample> out;
    out.reserve(rows.size());
    for (std::size_t i = 1; i + 1 < rows.size(); ++i) {
        const double passed_s = rows[i + 1].time_s - rows[i - 1].time_s;
        // The recorder's clock was set: no speed can be had across that.
        if (rows[i].stands || !(passed_s > 0.0) || (!out.empty() && rows[i].time_s < out.back().time_s)) continue;
        out.push_back({rows[i].time_s, (rows[i + 1].way_m - rows[i - 1].way_m) / passed_s, rows[i].pressure_Pa, rows[i].torque_Nm});
    }
    return out;
}

class Loader {
  public:
    explicit Loader(const StopFiles& files) : files_(files), layout_(antiskid::LayoutFiles(files.config, files.dbc, files.binding).load()) {
        for (const std::string& name : rig::friction_class_names()) classes_.push_back({name, {}});
    }

    void add(const StopSource& source) {
        if (!fs::exists(source.path)) throw Error(source.path.string(), 0, "", "is not there");
        fs::path path = source.path;
        if (path.extension() == ".sqlite") path = path.has_parent_path() ? path.parent_path() : fs::path(".");
        if (!fs::is_directory(path)) {
            add_file(path, source.kind);
        } else if (!rig::replay::log_in(path).empty()) {
            add_maneuver(path, source.kind);
        } else {
            const std::vector<fs::path> folders = maneuvers_below(path, 2);
            if (folders.empty())
                throw Error(path.string(), 0, "",
                            "holds no recorded maneuver: neither bus.log nor folders with one; a ledger of rig-lab endurance has no logs");
            for (const fs::path& folder : folders) add_maneuver(folder, source.kind);
        }
    }

    [[nodiscard]] std::vector<ClassStops> take() {
        std::erase_if(classes_, [](const ClassStops& c) { return c.stops.empty(); });
        return std::move(classes_);
    }

  private:
    void enter(const rig::LoadedRig& rig, wear::RecordedStop stop) {
        const auto at = std::find_if(classes_.begin(), classes_.end(), [&](const ClassStops& c) { return c.friction_class == rig.friction_class; });
        for (wear::BrakeSample& s : stop.samples) s.pressure_Pa = rig.rig.clamping.net_Pa(s.pressure_Pa);
        at->stops.push_back(std::move(stop));
    }

    void add_file(const fs::path& file, const std::string& kind) {
        if (kind.empty()) throw Error(file.string(), 0, "", fmt::format("which maneuver was it? Write e.g. light={}", file.string()));
        const rig::LoadedRig rig = rig_of(kind, file);
        if (is_csv(file))
            enter(rig, parse_stop(file.string(), settings::read_file(file), rig.rig.brake.gain_m3()));
        else
            enter(rig, read_log(file, rig));
    }

    void add_maneuver(const fs::path& folder, const std::string& kind) {
        const fs::path summary_file = folder / "summary.json";
        if (fs::exists(summary_file)) {
            const rig::record::Summary summary = rig::record::read_summary(summary_file);
            if (summary.outcome != "finished") {
                files_.warn(fmt::format("{}: {}: passed over", folder.string(), summary.outcome));
                return;
            }
            if (kind.empty()) {
                const rig::Scenario scenario = rig::load_scenario(files_.config / "scenarios" / (summary.scenario + ".toml"), files_.config);
                enter(scenario.rig, read_log(rig::replay::log_in(folder), scenario.rig));
                return;
            }
        }
        if (kind.empty())
            throw Error(folder.string(), 0, "",
                        fmt::format("has no summary.json that says which maneuver it was; write e.g. light={}", folder.string()));
        const rig::LoadedRig rig = rig_of(kind, folder);
        enter(rig, read_log(rig::replay::log_in(folder), rig));
    }

    [[nodiscard]] rig::LoadedRig rig_of(const std::string& kind, const fs::path& of) const {
        const std::vector<std::string> maneuvers = rig::maneuver_names(files_.config);
        rig::ManeuverChoice choice;
        choice.maneuver = kind;
        if (kind == rig::kEndurance) return rig::load_rig(files_.config, choice);
        const std::vector<std::string> classes = rig::friction_class_names();
        if (!contains(classes, kind)) {
            if (contains(maneuvers, kind)) return rig::load_rig(files_.config, choice);
            throw Error(of.string(), 0, "",
                        fmt::format("'{}' is neither a friction class ({}) nor a maneuver ({}, {})", kind, listed(classes), listed(maneuvers),
                                    rig::kEndurance));
        }
        for (const std::string& maneuver : maneuvers) {
            choice.maneuver = maneuver;
            rig::LoadedRig rig = rig::load_rig(files_.config, choice);
            if (rig.friction_class == kind) return rig;
        }
        throw Error(of.string(), 0, "", fmt::format("no maneuver of maneuvers.toml is of the class {}", kind));
    }

    /// The first braking of the log, sampled with every frame of the load cells.
    [[nodiscard]] wear::RecordedStop read_log(const fs::path& log, const rig::LoadedRig& rig) const {
        rig::replay::LogWarnings warnings(log.string(), files_.warn);
        rig::replay::LogOptions options;
        options.layout = &layout_;
        rig::replay::LogReader reader(log, options, warnings);
        const rig::RigParameters& r = rig.rig;
        constexpr double kPeriod_s = 1e-3;  // dates samples only; speeds are of the sensors' own clocks
        rig::record::BusMeter meter(layout_, rig::meter_parameters(rig, kPeriod_s));
        RoadWay road(r);
        std::vector<Raw> rows;
        double brake_on_mps = 0.0;
        Time newest = antiskid::control::kNever;
        bool loads_are_new = false;
        bool braking = false;
        for (rig::replay::LogFrame frame; reader.next(frame);) {
            meter.accept(frame.frame);
            const antiskid::can::BusView& v = meter.view();
            road.update(v.flywheel, frame.frame.received);
            const bool demanded = v.maneuver.arm && v.maneuver.demand_Pa > 0.0F;
            if (demanded && !braking) brake_on_mps = meter.meter().speed_mps();
            if (braking && !demanded) break;
            braking = demanded;
            if (v.load_cells_received != newest) {
                newest = v.load_cells_received;
                loads_are_new = true;
            }
            // Torque and pressure of one period: the load cells' frame may be ahead of that of the pressure.
            if (!braking || !loads_are_new || v.pressure.received < newest) continue;
            loads_are_new = false;
            rows.push_back({.time_s = seconds(newest),
                            .way_m = road.way_m(seconds(newest)),
                            .pressure_Pa = static_cast<double>(v.pressure.pressure_Pa),
                            .torque_Nm = static_cast<double>(v.load_cells.brake_torque_Nm),
                            .stands = meter.meter().slip() > kStands});
        }
        if (rows.empty())
            throw Error(log.string(), 0, "",
                        braking ? "no load cells' frame while it brakes: the torque was not recorded"
                                : "no braking in it: no maneuver command that is armed and demands pressure");
        return {log.string(), brake_on_mps, r.brake.gain_m3(), samples_of(rows)};
    }

    const StopFiles& files_;
    antiskid::can::Layout layout_;
    std::vector<ClassStops> classes_;
};

constexpr std::array<std::string_view, 4> kColumns{"time_s", "speed_mps", "pressure_Pa", "brake_torque_Nm"};

using Places = std::array<std::size_t, kColumns.size()>;

Places places_of(const std::vector<std::string_view>& header, const std::string& name, unsigned line) {
    Places places{};
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
        const auto at = std::find(header.begin(), header.end(), kColumns[i]);
        if (at == header.end())
            throw Error(name, line, std::string(kColumns[i]),
                        "no such column; a recorded stop needs time_s, speed_mps, pressure_Pa, brake_torque_Nm, named with these units");
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

StopSource parse_source(const std::string& text) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || fs::exists(text)) return {"", text};
    return {text.substr(0, equals), text.substr(equals + 1)};
}

std::vector<ClassStops> load_stops(const std::vector<StopSource>& sources, const StopFiles& files) {
    Loader loader(files);
    for (const StopSource& source : sources) loader.add(source);
    return loader.take();
}

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
