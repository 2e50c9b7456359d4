#include "plant_sim/study/robust/campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include "config/reader/hash.hpp"
#include "firmware/can/load_layout.hpp"
#include "firmware/linux/controller_config.hpp"
#include "plant_sim/model/load_rig.hpp"
#include "plant_sim/study/run_many.hpp"
#include "plant_sim/study/team/shared_work.hpp"
#include "plant_sim/study/team/team_alone.hpp"

namespace robust {

namespace {

using antiskid::control::Law;

Law law_of(const std::string& word) {
    if (word == "slip") return Law::wheel_slip;
    if (word == "threshold") return Law::threshold;
    if (word == "pressure_bias") return Law::pressure_bias;
    if (word == "peak_slip") return Law::peak_slip;
    throw std::invalid_argument("unknown law '" + word +
                                "'; there are slip, peak_slip, threshold, pressure_bias");
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

/// What two processes must have alike to work on one campaign.
std::string identity_of(const Plan& plan) {
    std::string text = fmt::format("{} {} {} {}", ANTISKID_VERSION, plan.config_hash, plan.seed, plan.draws);
    for (const Family family : plan.families) text.append(" ").append(name(family));
    for (const std::string& law : plan.law_names) text.append(" ").append(law);
    return text;
}

Row row_of(const Plan& plan, std::size_t stop) {
    return Row{.family = plan.families[stop / (plan.laws.size() * plan.draws)],
               .law = stop / plan.draws % plan.laws.size(),
               .number = stop % plan.draws,
               .figures = {},
               .faults = {}};
}

/// A stop as processes hand it over: its bytes, since all of them are the same program.
struct Finished {
    std::size_t stop = 0;
    Row row;
};
static_assert(std::is_trivially_copyable_v<Finished>);

std::string bytes_of(const Finished& finished) {
    std::string text(sizeof finished, '\0');
    std::memcpy(text.data(), &finished, sizeof finished);
    return text;
}

Finished read(std::string_view text) {
    Finished finished;
    if (text.size() != sizeof finished)
        throw std::invalid_argument("another process is of another version of this program");
    std::memcpy(&finished, text.data(), sizeof finished);
    return finished;
}

void run_share(const Plan& plan, const std::vector<std::size_t>& stops, const RunOptions& options,
               const study::HandIn& hand_in) {
    std::vector<std::shared_ptr<Travel>> travels(stops.size());
    const double period_s = static_cast<double>(plan.controller.period_s);
    const double ends_mps = plan.drop_out_mps;
    study::run_many(
        plan.layout, stops.size(),
        [&](std::size_t i) {
            const Row row = row_of(plan, stops[i]);
            const auto travel = travels[i] = std::make_shared<Travel>();
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
            Finished finished{.stop = stops[i], .row = row_of(plan, stops[i])};
            finished.row.figures = result.figures;
            finished.row.faults = result.faults;
            if (travels[i]->seconds > 0.0)
                finished.row.travel_mAps = travels[i]->sum_mA / travels[i]->seconds;
            hand_in(bytes_of(finished));
        },
        {.threads = options.threads, .stop = options.stop});
}

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

std::vector<Row> run(const Plan& plan, const RunOptions& options, study::Team& team) {
    const std::string identity = identity_of(plan);
    if (team.from_leader(identity) != identity)
        throw std::invalid_argument("this process was given other stops than the leading one");
    const std::vector<std::size_t> ours = study::share_of(study::order_of_work(plan.stops()), team);
    std::vector<std::optional<Row>> rows(plan.stops());
    std::size_t done = 0;
    study::work_together(
        team, [&](const study::HandIn& hand_in) { run_share(plan, ours, options, hand_in); },
        [&](std::string_view text) {
            const Finished finished = read(text);
            rows.at(finished.stop) = finished.row;
            if (options.progress) options.progress(++done);
        });
    std::vector<Row> finished;
    for (const std::optional<Row>& row : rows)
        if (row) finished.push_back(*row);
    return finished;
}

std::vector<Row> run(const Plan& plan, const RunOptions& options) {
    study::Alone team;
    return run(plan, options, team);
}

}  // namespace robust
