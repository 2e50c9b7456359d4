#include "plant_sim/lab/regulate_stops.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <iterator>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "firmware/can/load_layout.hpp"
#include "firmware/can/value_names.hpp"
#include "firmware/linux/controller_config.hpp"
#include "plant_sim/study/in_process.hpp"
#include "rig_bridge/record/meter.hpp"
#include "rig_bridge/scenario/meter_parameters.hpp"

namespace plant_sim {

namespace {

std::uint8_t phase_code(std::string_view name) {
    const auto& names = antiskid::can::kPhaseNames;
    return static_cast<std::uint8_t>(
        std::distance(names.begin(), std::find(names.begin(), names.end(), name)));
}

/// The rig's phases stand in the telemetry that the meter reads; the pilot's landing has those of them that matter.
std::uint8_t phase_code(study::Phase phase) {
    switch (phase) {
        case study::Phase::approach:
        case study::Phase::rolling:
            return phase_code("settling");
        case study::Phase::braking:
            return phase_code("braking");
        case study::Phase::standstill:
            return phase_code("standstill");
        case study::Phase::released:
        case study::Phase::done:
            break;
    }
    return phase_code("retract");
}

rig::ShaftSample shaft(const antiskid::can::SpeedSample& sample) {
    return {.edges = true,
            .edge_count = sample.edge_count,
            .edge_time = sample.edge_time,
            .speed_radps = static_cast<double>(sample.speed_radps)};
}

rig::MeterSample sample_of(const study::RigSession& session) {
    const antiskid::can::RigSample& sensed = session.sample();
    const antiskid::can::LoadCellSample cells = session.load_cells();
    return {.time_s = session.rig().time_s(),
            .phase = phase_code(session.pilot().phase()),
            .wheel = shaft(sensed.wheel),
            .flywheel = shaft(sensed.flywheel),
            .pressure_Pa = static_cast<double>(sensed.pressure_Pa),
            .vertical_N = static_cast<double>(cells.vertical_N),
            .longitudinal_N = static_cast<double>(cells.longitudinal_N),
            .brake_torque_Nm = static_cast<double>(cells.brake_torque_Nm)};
}

/// Friction of a worn-out brake over that of a new one.
double worn_friction(const wear::BrakeWear& brake) {
    return wear::expected_friction_at(*brake.model, brake.scale, {}, brake.life_J);
}

struct Job {
    std::size_t reference;
    std::size_t site;
    bool worn;
};

}  // namespace

double LandingSite::kinetic_J() const {
    const plant::RigParameters& p = rig.rig;
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
    const auto dbc = config / "antiskid.dbc";
    const auto binding = config / "antiskid_binding.toml";
    LandingSites s{.sites = {},
                   .controller = antiskid::load_controller_config(controller),
                   .layout = antiskid::can::load_layout(dbc, binding),
                   .files = {controller, dbc, binding}};
    for (const std::string& surface : plant::surface_names(config)) {
        for (const std::string& maneuver : plant::maneuver_names(config)) {
            plant::ManeuverChoice choice;
            choice.maneuver = maneuver;
            choice.surface = surface;
            s.sites.push_back({surface, maneuver, plant::load_rig(config, choice)});
        }
    }
    const auto& read = s.sites.front().rig.files;
    s.files.insert(s.files.end(), read.begin(), read.end());
    return s;
}

regulation::Stop land(const LandingSites& sites, const regulation::Draw& draw, double reference,
                      double mean_friction) {
    const LandingSite& site = sites.sites.at(draw.scenario);
    plant::RigParameters parameters = site.rig.rig;
    parameters.mean_friction = mean_friction;
    study::SessionOptions session;
    session.plan.slip_reference = reference;
    session.plan.demand_Pa = site.rig.full_pressure_Pa;
    session.period_s = static_cast<double>(sites.controller.period_s);
    session.drop_out_mps = site.rig.drop_out_mps;
    session.seed = draw.sensor_seed;
    rig::Meter meter(rig::meter_parameters(site.rig, session.period_s));
    const auto measure = [&](const study::RigSession& s, const antiskid::can::ControllerView&, double) {
        meter.feed(rig::as_on_bus(sites.layout, sample_of(s)));
    };
    const study::RunResult run = study::run_in_process(sites.controller, sites.layout, parameters, session,
                                                       study::Link::rounded, measure);
    if (!run.came_to_rest)
        throw std::runtime_error(
            fmt::format("the {} landing on {} with slip reference {:.3f}, friction {:.3f}, seed {} "
                        "did not come to rest",
                        site.maneuver, site.surface, reference, mean_friction, draw.sensor_seed));
    const rig::Figures measured = meter.figures();
    return {.measured = {.reference = reference,
                         .kinetic_J = measured.kinetic_energy_J,
                         .brake_J = measured.energy_brake_J,
                         .tyre_J = measured.energy_tyre_J,
                         .j_mu = measured.j_mu},
            .brake_J = run.figures.energy_brake_J,
            .tyre_J = run.figures.energy_tyre_J,
            .distance_m = run.figures.stop_distance_m,
            .j_mu = run.figures.j_mu};
}

int characterising_stops(const LandingSites& sites, const CharacteriseOptions& options) {
    return static_cast<int>(2 * sites.sites.size() * options.references.size());
}

regulation::Characterisation characterise(const LandingSites& sites, const CharacteriseOptions& options) {
    std::vector<Job> jobs;
    jobs.reserve(static_cast<std::size_t>(characterising_stops(sites, options)));
    for (std::size_t reference = 0; reference < options.references.size(); ++reference) {
        for (std::size_t site = 0; site < sites.sites.size(); ++site) {
            for (const bool worn : {false, true}) jobs.push_back({reference, site, worn});
        }
    }
    std::vector<regulation::Stop> stops(jobs.size());
    std::atomic<std::size_t> next{0};
    std::atomic<bool> over{false};
    std::mutex mutex;  // of done, failure and on_stop
    int done = 0;
    std::exception_ptr failure;
    const auto run = [&] {
        try {
            while (!over.load()) {
                const std::size_t i = next.fetch_add(1);
                if (i >= jobs.size()) return;
                if (options.stop != nullptr && options.stop->load()) over.store(true);
                const plant::LoadedRig& rig = sites.sites[jobs[i].site].rig;
                const double friction = jobs[i].worn ? worn_friction(rig.wear) : rig.rig.mean_friction;
                stops[i] = land(sites, {.scenario = jobs[i].site, .sensor_seed = options.seed},
                                options.references[jobs[i].reference], friction);
                const std::scoped_lock lock(mutex);
                if (options.on_stop) options.on_stop(++done);
            }
        } catch (...) {
            const std::scoped_lock lock(mutex);
            if (!failure) failure = std::current_exception();
            over.store(true);
        }
    };
    {
        std::vector<std::jthread> threads;
        for (unsigned i = 1; i < options.threads; ++i) threads.emplace_back(run);
        run();
    }
    if (failure) std::rethrow_exception(failure);
    regulation::Characterisation c;
    if (over.load()) return c;
    c.floor.reference = options.references;
    std::vector<double> tyre_J(options.references.size());
    std::vector<double> all_J(options.references.size());
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        const std::string& surface = sites.sites[jobs[i].site].surface;
        auto row = std::find_if(c.floor.rows.begin(), c.floor.rows.end(),
                                [&](const auto& r) { return r.surface == surface; });
        if (row == c.floor.rows.end())
            row = c.floor.rows.insert(row, {surface, std::vector<double>(options.references.size(), 1.0)});
        double& least = row->j_mu[jobs[i].reference];
        least = std::min(least, stops[i].j_mu);
        tyre_J[jobs[i].reference] += stops[i].tyre_J;
        all_J[jobs[i].reference] += stops[i].tyre_J + stops[i].brake_J;
    }
    c.tyre_share.reserve(tyre_J.size());
    for (std::size_t i = 0; i < tyre_J.size(); ++i) c.tyre_share.push_back(tyre_J[i] / all_J[i]);
    return c;
}

}  // namespace plant_sim
