#include "plant_sim/python/scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>

#include "plant_sim/python/arrays.hpp"
#include "plant_sim/study/drive.hpp"
#include "plant_sim/study/run_many.hpp"

namespace plant_sim::python {

namespace {

/// One keyword of a scenario, and where its value goes.
struct Keyword {
    const char* name;
    void (*set)(StopOptions& options, const py::handle& value);
};

constexpr std::array<Keyword, 15> kKeywords{{
    {"maneuver", [](StopOptions& o, const py::handle& v) { o.choice.maneuver = v.cast<std::string>(); }},
    {"surface", [](StopOptions& o, const py::handle& v) { o.choice.surface = v.cast<std::string>(); }},
    {"runway", [](StopOptions& o, const py::handle& v) { o.choice.runway = v.cast<std::filesystem::path>(); }},
    {"on_flywheel", [](StopOptions& o, const py::handle& v) { o.choice.carrier = v.cast<bool>() ? rig::Carrier::flywheel : rig::Carrier::aircraft; }},
    {"mass_kg", [](StopOptions& o, const py::handle& v) { o.choice.mass_kg = v.cast<double>(); }},
    {"speed_mps", [](StopOptions& o, const py::handle& v) { o.choice.speed_mps = v.cast<double>(); }},
    {"mean_friction", [](StopOptions& o, const py::handle& v) { o.choice.friction = v.cast<double>(); }},
    {"law", [](StopOptions& o, const py::handle& v) { o.law = v.cast<std::string>(); }},
    {"slip", [](StopOptions& o, const py::handle& v) { o.slip = v.cast<double>(); }},
    {"deceleration_mps2", [](StopOptions& o, const py::handle& v) { o.deceleration_mps2 = v.cast<double>(); }},
    {"seed", [](StopOptions& o, const py::handle& v) { o.seed = v.cast<std::uint64_t>(); }},
    {"config", [](StopOptions& o, const py::handle& v) { o.config = v.cast<std::filesystem::path>(); }},
    {"controller", [](StopOptions& o, const py::handle& v) { o.controller = v.cast<std::filesystem::path>(); }},
    {"dbc", [](StopOptions& o, const py::handle& v) { o.dbc = v.cast<std::filesystem::path>(); }},
    {"binding", [](StopOptions& o, const py::handle& v) { o.binding = v.cast<std::filesystem::path>(); }},
}};

void check_slip(double slip) {
    if (!(slip >= 0.0 && slip <= 0.5)) throw std::invalid_argument("slip: " + std::to_string(slip) + " is out of range 0 to 0.5");
}

StopOptions options_of(const py::kwargs& keywords) {
    StopOptions options;
    for (const auto& [key, value] : keywords) {
        const auto name = key.cast<std::string>();
        const auto* const found = std::find_if(kKeywords.begin(), kKeywords.end(), [&](const Keyword& k) { return name == k.name; });
        if (found == kKeywords.end()) {
            std::string known;
            for (const Keyword& k : kKeywords) known.append(known.empty() ? "" : ", ").append(k.name);
            throw py::type_error(fmt::format("there is no '{}'; there are: {}", name, known));
        }
        if (!value.is_none()) found->set(options, value);
    }
    constexpr std::array kLaws{"slip", "peak_slip", "threshold", "pressure_bias", "deceleration"};
    if (std::find(kLaws.begin(), kLaws.end(), options.law) == kLaws.end())
        throw std::invalid_argument("law: '" + options.law + "' is none of slip, peak_slip, threshold, pressure_bias, deceleration");
    check_slip(options.slip);
    return options;
}

/// A row for each control period; names as in the trajectory of `rig-lab stop`.
class Columns {
  public:
    void record(const study::RigSession& session, const antiskid::can::ControllerView& controller, double current_mA) {
        const plant::Rig& rig = session.rig();
        const plant::WheelState& w = rig.wheel();
        const plant::Forces f = rig.forces();
        const std::array<double, kNames.size()> row{rig.time_s(),
                                                    w.v_mps,
                                                    w.omega_radps * f.radius_m,
                                                    f.slip,
                                                    static_cast<double>(controller.slip_reference),
                                                    static_cast<double>(session.sample().maneuver.demand_Pa),
                                                    rig.pressure_Pa(),
                                                    current_mA,
                                                    f.brake_torque_Nm,
                                                    f.F_x_N,
                                                    f.F_z_N,
                                                    f.mu,
                                                    w.energy_brake_J,
                                                    w.energy_tyre_J};
        for (std::size_t i = 0; i < row.size(); ++i) values_[i].push_back(row[i]);
    }
    [[nodiscard]] py::dict arrays() const {
        py::dict out;
        for (std::size_t i = 0; i < kNames.size(); ++i) out[kNames[i]] = column(values_[i]);
        return out;
    }

  private:
    static constexpr std::array kNames{"time_s",         "speed_mps",    "wheel_rim_speed_mps", "slip",  "slip_reference", "pressure_demand_Pa",
                                       "pressure_Pa",    "current_mA",   "brake_torque_Nm",     "F_x_N", "F_z_N",          "mu",
                                       "energy_brake_J", "energy_tyre_J"};
    std::array<std::vector<double>, kNames.size()> values_;
};

struct Figure {
    const char* name;
    double (*of)(const study::RunResult& result);
};

double or_nan(const std::optional<double>& value) {
    return value.value_or(std::numeric_limits<double>::quiet_NaN());
}

constexpr std::array<Figure, 14> kFigures{{
    {"stop_distance_m", [](const study::RunResult& r) { return r.figures.stop_distance_m; }},
    {"duration_s", [](const study::RunResult& r) { return r.figures.duration_s; }},
    {"j_mu", [](const study::RunResult& r) { return r.figures.j_mu; }},
    {"slip_efficiency", [](const study::RunResult& r) { return r.figures.slip_efficiency; }},
    {"energy_brake_J", [](const study::RunResult& r) { return r.figures.energy_brake_J; }},
    {"energy_tyre_J", [](const study::RunResult& r) { return r.figures.energy_tyre_J; }},
    {"energy_residual", [](const study::RunResult& r) { return r.figures.energy_residual; }},
    {"peak_slip", [](const study::RunResult& r) { return r.figures.peak_slip; }},
    {"tracked_share", [](const study::RunResult& r) { return or_nan(r.figures.tracked_share); }},
    {"longest_lock_s", [](const study::RunResult& r) { return r.figures.longest_lock_s; }},
    {"mean_friction", [](const study::RunResult& r) { return r.figures.mean_friction; }},
    {"mean_torque_Nm", [](const study::RunResult& r) { return r.figures.mean_torque_Nm; }},
    {"mean_load_N", [](const study::RunResult& r) { return r.figures.mean_load_N; }},
    {"standstill", [](const study::RunResult& r) { return r.figures.standstill ? 1.0 : 0.0; }},
}};

}  // namespace

Scenario::Scenario(const py::kwargs& keywords) : options_(options_of(keywords)), inputs_(load_scenario(options_)) {}

py::object Scenario::figures(const study::RunResult& result, double slip_reference, std::uint64_t seed) const {
    study::StopReport report = inputs_.report(options_, result);
    report.slip_reference = slip_reference;
    report.seed = seed;
    return py::module_::import("json").attr("loads")(study::to_json(report));
}

py::object Scenario::stop() const {
    const study::RunResult result = [&] {
        const py::gil_scoped_release others_run;
        return study::run_in_process(inputs_.controller, inputs_.layout, inputs_.plant.rig, inputs_.session, study::Link::frames);
    }();
    return figures(result, options_.slip, options_.seed);
}

py::tuple Scenario::recorded_stop() const {
    Columns columns;
    const study::RunResult result = [&] {
        const py::gil_scoped_release others_run;
        const auto on_step = [&](const study::RigSession& session, const antiskid::can::ControllerView& view, double current_mA) {
            columns.record(session, view, current_mA);
        };
        return study::run_in_process(inputs_.controller, inputs_.layout, inputs_.plant.rig, inputs_.session, study::Link::frames, on_step);
    }();
    return py::make_tuple(figures(result, options_.slip, options_.seed), columns.arrays());
}

py::dict Scenario::stops(const std::vector<double>& slip, const std::vector<std::uint64_t>& seed, unsigned threads) const {
    if (seed.size() != slip.size() && seed.size() > 1) throw std::invalid_argument("seed: expected one, or as many as there are slip references");
    if (threads < 1) throw std::invalid_argument("threads: expected 1 or more");
    std::for_each(slip.begin(), slip.end(), check_slip);
    std::vector<study::RunResult> results(slip.size());
    {
        const py::gil_scoped_release others_run;
        const auto make = [&](std::size_t i) {
            study::Maneuver maneuver{.controller = inputs_.controller, .rig = inputs_.plant.rig, .options = inputs_.session};
            maneuver.options.plan.slip_reference = slip[i];
            if (!seed.empty()) maneuver.options.seed = seed[seed.size() == 1 ? 0 : i];
            return maneuver;
        };
        const auto done = [&](std::size_t i, const study::RunResult& result) { results[i] = result; };
        study::run_many(inputs_.layout, slip.size(), make, done, {.threads = threads});
    }
    py::dict out;
    out["slip_reference"] = column(slip);
    for (const Figure& figure : kFigures) out[figure.name] = column(results, figure.of);
    return out;
}

py::dict Scenario::drive(const std::vector<double>& time_s, const std::optional<std::vector<double>>& pressure_Pa,
                         const std::optional<std::vector<double>>& current_mA) const {
    if (pressure_Pa.has_value() == current_mA.has_value()) throw std::invalid_argument("expected one of pressure_Pa and current_mA");
    std::vector<study::DriveRow> rows;
    {
        const py::gil_scoped_release others_run;
        const auto input = pressure_Pa ? study::DriveInput::pressure_Pa : study::DriveInput::current_mA;
        study::drive(inputs_.plant.rig, study::profile_of("profile", input, time_s, pressure_Pa ? *pressure_Pa : *current_mA),
                     [&rows](const study::DriveRow& row) { rows.push_back(row); });
    }
    py::dict out;
    for (std::size_t i = 0; i < study::kDriveColumns.size(); ++i)
        out[study::kDriveColumns.at(i)] = column(rows, [i](const study::DriveRow& row) { return row.at(i); });
    return out;
}

}  // namespace plant_sim::python
