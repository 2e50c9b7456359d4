#include "plant_sim/study/robust/campaign.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>

#include "config/reader/hash.hpp"
#include "firmware/can/load_layout.hpp"
#include "firmware/linux/controller_config.hpp"
#include "plant_sim/model/load_rig.hpp"
#include "plant_sim/study/run_many.hpp"

namespace robust {

namespace {

using antiskid::control::Law;

Law law_of(const std::string& word) {
    if (word == "slip") return Law::wheel_slip;
    if (word == "threshold") return Law::threshold;
    if (word == "pressure_bias") return Law::pressure_bias;
    throw std::invalid_argument("unknown law '" + word + "'; there are slip, threshold, pressure_bias");
}

Family family_of(const std::string& word) {
    const auto at = std::find(kFamilyNames.begin(), kFamilyNames.end(), word);
    if (at != kFamilyNames.end()) return static_cast<Family>(at - kFamilyNames.begin());
    std::string known;
    for (const std::string_view name : kFamilyNames) known += (known.empty() ? "" : ", ") + std::string(name);
    throw std::invalid_argument("unknown family '" + word + "'; there are " + known);
}

/// Travel of the valve current while braking above drop-out.
struct Travel {
    double last_mA = 0.0, sum_mA = 0.0, seconds = 0.0;
};

}  // namespace

Plan load_plan(const PlanOptions& o) {
    const auto or_default = [&](const std::filesystem::path& given, const char* name) {
        return given.empty() ? o.config / name : given;
    };
    const auto ranges = or_default(o.ranges, "uncertainty.toml");
    const auto controller = or_default(o.controller, "controller.toml");
    Plan plan{
        .basis = {.uncertainty = load_uncertainty(ranges), .landings = {}, .surfaces = {}},
        .controller = antiskid::load_controller_config(controller),
        .layout = antiskid::can::load_layout(o.config / "antiskid.dbc", o.config / "antiskid_binding.toml"),
        .families = {},
        .laws = {},
        .law_names = o.laws,
        .draws = o.draws,
        .seed = o.seed,
        .config_hash = {}};
    for (const std::string& word : o.families) plan.families.push_back(family_of(word));
    for (const std::string& word : o.laws) plan.laws.push_back(law_of(word));
    std::vector<std::filesystem::path> files{ranges, controller};
    for (const std::string& surface : plant::surface_names(o.config)) {
        for (const char* maneuver : {"light", "heavy"}) {
            plant::ManeuverChoice choice;
            choice.surface = surface;
            choice.maneuver = maneuver;
            const plant::LoadedRig loaded = plant::load_rig(o.config, choice);
            if (surface != "ice") plan.basis.landings.push_back({surface, maneuver, loaded.rig});
            plan.drop_out_mps = loaded.drop_out_mps;
            plan.demand_Pa = loaded.full_pressure_Pa;
            if (plan.basis.landings.size() == 1)
                files.insert(files.end(), loaded.files.begin(), loaded.files.end());
            if (maneuver == std::string("light")) plan.basis.surfaces.push_back(loaded.rig.surface);
        }
    }
    plan.config_hash = settings::hash(files);
    return plan;
}

study::SessionOptions session(const Plan& plan, Law law, std::size_t number) {
    study::SessionOptions s;
    s.plan.law = law;
    s.plan.slip_reference = plan.basis.uncertainty.slip_reference;
    s.plan.demand_Pa = plan.demand_Pa;
    s.period_s = static_cast<double>(plan.controller.period_s);
    s.drop_out_mps = plan.drop_out_mps;
    s.seed = plan.seed + number;
    return s;
}

std::vector<Row> run(const Plan& plan, const RunOptions& options) {
    const std::size_t count = plan.stops();
    const auto row_of = [&](std::size_t i) {
        return Row{.family = plan.families[i / (plan.laws.size() * plan.draws)],
                   .law = i / plan.draws % plan.laws.size(),
                   .number = i % plan.draws,
                   .figures = {},
                   .faults = {}};
    };
    std::vector<std::optional<Row>> rows(count);
    std::vector<std::shared_ptr<Travel>> travels(count);
    std::size_t done = 0;
    const double period_s = static_cast<double>(plan.controller.period_s);
    study::run_many(
        plan.layout, count,
        [&](std::size_t i) {
            const Row row = row_of(i);
            const auto travel = travels[i] = std::make_shared<Travel>();
            const double ends_mps = plan.drop_out_mps;
            return study::Maneuver{
                plan.controller, draw(plan.basis, row.family, plan.seed, row.number).rig,
                session(plan, plan.laws[row.law], row.number),
                [travel, period_s, ends_mps](const study::RigSession& s, const antiskid::can::ControllerView&,
                                             double current_mA) {
                    if (s.pilot().phase() == study::Phase::braking && s.rig().wheel().v_mps > ends_mps) {
                        travel->sum_mA += std::abs(current_mA - travel->last_mA);
                        travel->seconds += period_s;
                    }
                    travel->last_mA = current_mA;
                }};
        },
        [&](std::size_t i, const study::RunResult& result) {
            Row row = row_of(i);
            row.figures = result.figures;
            row.faults = result.faults;
            if (travels[i]->seconds > 0.0) row.travel_mAps = travels[i]->sum_mA / travels[i]->seconds;
            rows[i] = row;
            if (options.progress) options.progress(++done);
        },
        {.threads = options.threads, .stop = options.stop});
    std::vector<Row> finished;
    for (const std::optional<Row>& row : rows)
        if (row) finished.push_back(*row);
    return finished;
}

}  // namespace robust
