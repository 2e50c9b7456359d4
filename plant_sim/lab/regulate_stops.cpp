#include "plant_sim/lab/regulate_stops.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <numeric>
#include <stdexcept>

#include "firmware/can/value_names.hpp"
#include "firmware/host/controller_config.hpp"
#include "firmware/host/layout_files.hpp"
#include "plant_sim/study/run_many.hpp"
#include "rig_bridge/record/meter.hpp"
#include "rig_bridge/rig/friction_curve.hpp"
#include "rig_bridge/rig/meter_parameters.hpp"

namespace plant_sim::lab {

namespace {

/// The rig's phase for each phase of the pilot's landing: the meter reads the rig's phases.
constexpr std::array<std::string_view, 6> kRigPhases{"settling", "settling", "braking", "standstill", "retract", "retract"};

std::uint8_t phase_code(study::StopPhase phase) {
    const auto& names = antiskid::can::kPhaseNames;
    const auto* const found = std::find(names.begin(), names.end(), kRigPhases[static_cast<std::size_t>(phase)]);
    return static_cast<std::uint8_t>(std::distance(names.begin(), found));
}

rig::record::MeterSample sample_of(const study::RigSession& session) {
    const antiskid::can::RigSample& sensed = session.sample();
    const antiskid::can::LoadCellSample cells = session.load_cells();
    return {.time_s = session.rig().time_s(),
            .phase = phase_code(session.pilot().phase()),
            .wheel = rig::record::shaft_sample(sensed.wheel),
            .flywheel = rig::record::shaft_sample(sensed.flywheel),
            .pressure_Pa = static_cast<double>(sensed.pressure_Pa),
            .vertical_N = static_cast<double>(cells.vertical_N),
            .longitudinal_N = static_cast<double>(cells.longitudinal_N),
            .brake_torque_Nm = static_cast<double>(cells.brake_torque_Nm)};
}

/// Friction of a worn-out brake over that of a new one.
double worn_friction(const wear::BrakeWear& brake) {
    return wear::expected_friction_at(*brake.model, brake.scale, {}, brake.life_J);
}

/// Roughly, of a stop: speed over the friction that there is.
double expected_s(const LandingSite& site) {
    return site.rig.rig.brake_on_mps / rig::peak(site.rig.rig.surface).mu;
}

study::Maneuver maneuver_of(const LandingSites& sites, const regulation::LandingRequest& request) {
    const LandingSite& site = sites.sites.at(request.draw.scenario);
    study::Maneuver m{.controller = sites.controller, .rig = site.rig.rig, .options = {}};
    m.rig.mean_friction = request.mean_friction;
    m.options.plan.slip_reference = request.reference;
    m.options.plan.demand_Pa = site.rig.full_pressure_Pa;
    m.options.period_s = static_cast<double>(sites.controller.period_s);
    m.options.drop_out_mps = site.rig.drop_out_mps;
    m.options.seed = request.draw.sensor_seed;
    return m;
}

regulation::Stop stop_of(const LandingSite& site, const regulation::LandingRequest& request, const study::StopFigures& run,
                         const rig::record::Meter* meter) {
    regulation::Stop stop{
        .measured = {}, .brake_J = run.energy_brake_J, .tyre_J = run.energy_tyre_J, .distance_m = run.stop_distance_m, .j_mu = run.j_mu};
    if (meter == nullptr) return stop;
    const rig::record::Figures measured = meter->figures();
    stop.measured = {.reference = request.reference,
                     .kinetic_J = measured.kinetic_energy_J,
                     .brake_J = measured.energy_brake_J,
                     .tyre_J = measured.energy_tyre_J,
                     .j_mu = measured.j_mu};
    stop.measured_friction =
        rig::mean_of_measured(site.rig.rig.friction_curve, measured.mean_friction, site.rig.drop_out_mps / measured.brake_on_mps);
    return stop;
}

}  // namespace

double LandingSite::kinetic_J() const {
    const rig::RigParameters& p = rig.rig;
    const double touchdown = p.touchdown_mps > 0.0 ? p.touchdown_mps : p.brake_on_mps;
    const double load_N = p.load.base_N - p.load.lift_Ns2pm2 * touchdown * touchdown;
    const double r = p.wheel.free_radius_m - load_N / p.wheel.stiffness_Npm;
    // m (v_touchdown - v) = J_w v / r^2: the aircraft gives the wheel its spin, and the runway as much heat again.
    const double wheel_kg = p.wheel.inertia_kgm2 / (r * r);
    const double v = touchdown * p.wheel.mass_kg / (p.wheel.mass_kg + wheel_kg);
    return 0.5 * (p.wheel.mass_kg + wheel_kg) * v * v;
}

double LandingSites::mean_J() const {
    double sum = 0.0;
    for (const LandingSite& site : sites) sum += site.kinetic_J();
    return sum / static_cast<double>(sites.size());
}

double LandingSites::deviation_J() const {
    const double mean = mean_J();
    double sum = 0.0;
    for (const LandingSite& site : sites) sum += (site.kinetic_J() - mean) * (site.kinetic_J() - mean);
    return std::sqrt(sum / static_cast<double>(sites.size()));
}

LandingSites load_sites(const std::filesystem::path& config) {
    const auto controller = config / "controller.toml";
    const antiskid::LayoutFiles layout(config);
    const antiskid::control::Config loaded = antiskid::load_controller_config(controller);
    LandingSites s{.sites = {},
                   .controller = loaded,
                   .layout = layout.load(antiskid::required_range(loaded)),
                   .files = {controller, layout.dbc, layout.binding}};
    for (const std::string& surface : rig::surface_names(config)) {
        for (const std::string& maneuver : rig::maneuver_names(config)) {
            rig::ManeuverChoice choice;
            choice.maneuver = maneuver;
            choice.surface = surface;
            s.sites.push_back({surface, maneuver, rig::load_rig(config, choice)});
        }
    }
    const auto& read = s.sites.front().rig.files;
    s.files.insert(s.files.end(), read.begin(), read.end());
    return s;
}

std::vector<regulation::Stop> land(const LandingSites& sites, std::span<const regulation::LandingRequest> requests, unsigned threads) {
    // Long stops first, so that threads end together.
    std::vector<std::size_t> order(requests.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return expected_s(sites.sites.at(requests[a].draw.scenario)) > expected_s(sites.sites.at(requests[b].draw.scenario));
    });
    std::vector<regulation::Stop> stops(requests.size());
    std::vector<std::unique_ptr<rig::record::Meter>> meters(requests.size());
    const auto make = [&](std::size_t i) {
        const regulation::LandingRequest& request = requests[order[i]];
        study::Maneuver m = maneuver_of(sites, request);
        if (!request.metered) return m;
        meters[i] = std::make_unique<rig::record::Meter>(rig::meter_parameters(sites.sites[request.draw.scenario].rig, m.options.period_s));
        m.on_step = [meter = meters[i].get(), &sites](const study::RigSession& session, const antiskid::can::ControllerView&, double) {
            meter->feed(rig::record::as_on_bus(sites.layout, sample_of(session)));
        };
        return m;
    };
    const auto done = [&](std::size_t i, const study::RunResult& run) {
        const regulation::LandingRequest& request = requests[order[i]];
        const LandingSite& site = sites.sites[request.draw.scenario];
        if (!run.came_to_rest)
            throw std::runtime_error(fmt::format("the {} landing on {} with slip reference {:.3f}, friction {:.3f}, seed {} did not come to rest",
                                                 site.maneuver, site.surface, request.reference, request.mean_friction, request.draw.sensor_seed));
        stops[order[i]] = stop_of(site, request, run.figures, meters[i].get());
        meters[i].reset();
    };
    study::run_many(sites.layout, order.size(), make, done, {.threads = threads});
    return stops;
}

std::size_t characterising_stops(const LandingSites& sites, const CharacteriseOptions& options) {
    return 2 * sites.sites.size() * options.references.size();
}

std::vector<regulation::Stop> land_by_table(const LandingSites& sites, const wear::SurfaceTable& table,
                                            std::span<const regulation::LandingRequest> requests) {
    std::vector<regulation::Stop> stops;
    stops.reserve(requests.size());
    for (const regulation::LandingRequest& request : requests) {
        const LandingSite& site = sites.sites.at(request.draw.scenario);
        const wear::SurfaceTable::Row& row = *table.find(site.surface);
        const double energy_J = site.kinetic_J();
        const double tyre_J = table.at(row.tyre_share, request.reference) * energy_J;
        regulation::Stop& stop = stops.emplace_back();
        stop.brake_J = energy_J - tyre_J;
        stop.tyre_J = tyre_J;
        stop.distance_m = table.at(row.distance_m, request.reference);
        stop.j_mu = table.at(row.j_mu, request.reference);
        stop.measured = {.reference = request.reference, .kinetic_J = energy_J, .brake_J = stop.brake_J, .tyre_J = stop.tyre_J, .j_mu = stop.j_mu};
        stop.measured_friction = request.mean_friction;
    }
    return stops;
}

wear::SurfaceTable characterise(const LandingSites& sites, const CharacteriseOptions& options) {
    struct Sum {
        double tyre_J = 0.0, all_J = 0.0, distance_m = 0.0, stops = 0.0;
    };
    wear::SurfaceTable table{.reference = options.references, .rows = {}};
    const std::size_t count = options.references.size();
    for (const LandingSite& site : sites.sites) {
        if (table.find(site.surface) != nullptr) continue;
        const std::vector<double> none(count);
        table.rows.push_back({.surface = site.surface, .j_mu = std::vector<double>(count, 1.0), .tyre_share = none, .distance_m = none});
    }
    for (std::size_t i = 0; i < count; ++i) {
        std::vector<regulation::LandingRequest> requests;
        for (std::size_t site = 0; site < sites.sites.size(); ++site) {
            const rig::LoadedRig& rig = sites.sites[site].rig;
            for (const double friction : {rig.rig.mean_friction, worn_friction(rig.wear)})
                requests.push_back({.draw = {.scenario = site, .sensor_seed = options.seed},
                                    .reference = options.references[i],
                                    .mean_friction = friction,
                                    .metered = false});
        }
        if (options.stop != nullptr && options.stop->load()) return {};
        const std::vector<regulation::Stop> stops = land(sites, requests, options.threads);
        if (options.on_stops) options.on_stops((i + 1) * requests.size());
        for (wear::SurfaceTable::Row& row : table.rows) {
            Sum sum;
            for (std::size_t k = 0; k < requests.size(); ++k) {
                if (sites.sites[requests[k].draw.scenario].surface != row.surface) continue;
                row.j_mu[i] = std::min(row.j_mu[i], stops[k].j_mu);
                sum.tyre_J += stops[k].tyre_J;
                sum.all_J += stops[k].tyre_J + stops[k].brake_J;
                sum.distance_m += stops[k].distance_m;
                sum.stops += 1.0;
            }
            row.tyre_share[i] = sum.tyre_J / sum.all_J;
            row.distance_m[i] = sum.distance_m / sum.stops;
        }
    }
    return table;
}

}  // namespace plant_sim::lab
