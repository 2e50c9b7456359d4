#include <atomic>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "plant_sim/python/bindings.hpp"
#include "plant_sim/python/interruptible.hpp"
#include "plant_sim/study/margins/margins_input.hpp"
#include "plant_sim/study/margins/margins_report.hpp"
#include "plant_sim/study/robust/report.hpp"
#include "plant_sim/study/sweep/run.hpp"
#include "plant_sim/study/sweep/stops_table.hpp"
#include "plant_sim/study/sweep/summary.hpp"
#include "plant_sim/study/team/shared_work.hpp"
#include "rig_bridge/wear/on_threads.hpp"

namespace plant_sim::python {

namespace {

/// Texts of results.json and stops.csv.
struct StudyFiles {
    std::string results, stops;
};

/// 0: all cores.
unsigned threads_of(unsigned asked) {
    return asked > 0 ? asked : wear::all_cores();
}

StudyFiles sweep_study(const sweep::SweepPlanOptions& options, unsigned threads) {
    if (options.landings < 1) throw std::invalid_argument("landings: expected 1 or more");
    sweep::SweepPlanOptions asked = options;
    const auto references = sweep::in_whole_steps(options.references);
    if (!references || references->empty()) throw std::invalid_argument("references: expected some, increasing, from 0.01 to 0.5");
    asked.references = *references;
    std::atomic<bool> stop{false};
    const auto study = [&] {
        const sweep::SweepPlan plan = sweep::load_plan(asked);
        const std::vector<sweep::SweptStop> rows =
            sweep::run(plan, study::team::order_of_work(plan.stops()), {.threads = threads_of(threads), .stop = &stop});
        if (rows.size() < plan.stops()) return StudyFiles{};
        const sweep::Identity identity = sweep::identity_of(plan);
        StudyFiles files;
        files.results = sweep::to_json(sweep::summarised(identity, rows));
        files.stops = sweep::to_csv(identity, rows);
        return files;
    };
    return interruptible(study, [&] { stop = true; });
}

StudyFiles robust_study(const robust::RobustPlanOptions& options, unsigned threads) {
    if (options.draws < 1) throw std::invalid_argument("draws: expected 1 or more");
    std::atomic<bool> stop{false};
    const auto study = [&] {
        const robust::RobustPlan plan = robust::load_plan(options);
        const std::vector<robust::DrawnStop> rows = robust::run(plan, {.threads = threads_of(threads), .stop = &stop});
        if (rows.size() < plan.stops()) return StudyFiles{};
        StudyFiles files;
        files.results = robust::to_json(plan, rows, robust::summarise(plan, rows));
        files.stops = robust::to_csv(plan, rows);
        return files;
    };
    return interruptible(study, [&] { stop = true; });
}

/// The slip reference of `scenario` replaces that of `options`.
std::string margins_study(const StopOptions& scenario, study::margins::StudyOptions options) {
    namespace margins = study::margins;
    if (!(scenario.slip >= 0.01 && scenario.slip <= 0.5)) throw std::invalid_argument("slip: expected 0.01 to 0.5");
    if (options.speeds < 2 || options.speeds > 200) throw std::invalid_argument("speeds: expected 2 to 200");
    std::atomic<bool> stop{false};
    const auto study = [&] {
        const margins::MarginsInput input = margins::load_margins_input(scenario);
        options.slip_reference = scenario.slip;
        options.requirement = input.settings.requirement;
        const auto cells =
            margins::study_cells(input.cases, input.scenarios.front().controller, input.settings.pid, options, [&](std::size_t, std::size_t) {
                if (stop) throw std::runtime_error("stopped");
            });
        return margins::to_json(input.cases, cells,
                                {.config_hash = input.config_hash,
                                 .version = ANTISKID_VERSION,
                                 .options = options,
                                 .pid = input.settings.pid,
                                 .tyre = margins::tyre_name(input.cases.front().rig.wheel.compliance)});
    };
    return interruptible(study, [&] { stop = true; });
}

}  // namespace

/// The module's __init__.py makes Python's own of the texts.
void bind_studies(py::module_& m) {
    const auto both = [](const StudyFiles& files) { return py::make_tuple(files.results, files.stops); };
    const sweep::SweepPlanOptions swept;
    m.def(
        "sweep",
        [both](const std::optional<Numbers>& references, std::size_t landings, bool threshold, std::uint64_t seed, const Directory& config,
               unsigned threads) {
            return both(sweep_study({.config = directory_of(config),
                                     .references = references ? *references : sweep::paper_references(),
                                     .landings = landings,
                                     .threshold = threshold,
                                     .seed = seed},
                                    threads));
        },
        py::arg("references") = py::none(), py::kw_only(), py::arg("landings") = swept.landings, py::arg("threshold") = swept.threshold,
        py::arg("seed") = swept.seed, py::arg("config") = py::none(), py::arg("threads") = 0);
    const robust::RobustPlanOptions drawn;
    m.def(
        "robust",
        [both](const std::vector<std::string>& families, const std::vector<std::string>& laws, std::size_t draws, std::uint64_t seed,
               const std::filesystem::path& controller, const std::filesystem::path& ranges, const Directory& config, unsigned threads) {
            return both(robust_study({.config = directory_of(config),
                                      .controller = controller,
                                      .ranges = ranges,
                                      .families = families,
                                      .laws = laws,
                                      .draws = draws,
                                      .seed = seed},
                                     threads));
        },
        py::kw_only(), py::arg("families") = drawn.families, py::arg("laws") = drawn.laws, py::arg("draws") = drawn.draws,
        py::arg("seed") = drawn.seed, py::arg("controller") = "", py::arg("ranges") = "", py::arg("config") = py::none(), py::arg("threads") = 0);
    const study::margins::StudyOptions grid;
    m.def(
        "margins",
        [](double slip, int speeds, bool constant_slip, std::optional<double> mean_friction, const std::filesystem::path& controller,
           const Directory& config) {
            StopOptions scenario;
            scenario.config = directory_of(config);
            scenario.controller = controller;
            scenario.choice.friction = mean_friction;
            scenario.slip = slip;
            study::margins::StudyOptions options;
            options.speeds = speeds;
            options.low_speed_fall = !constant_slip;
            return margins_study(scenario, options);
        },
        py::kw_only(), py::arg("slip") = grid.slip_reference, py::arg("speeds") = grid.speeds, py::arg("constant_slip") = !grid.low_speed_fall,
        py::arg("mean_friction") = py::none(), py::arg("controller") = "", py::arg("config") = py::none());
}

}  // namespace plant_sim::python
