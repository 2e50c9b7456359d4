#include "plant_sim/study/robust/robust_campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include "firmware/control/slip_law.hpp"
#include "firmware/host/controller_config.hpp"
#include "firmware/host/layout_files.hpp"
#include "firmware/host/settings/hash.hpp"
#include "plant_sim/study/loop.hpp"
#include "plant_sim/study/robust/grids.hpp"
#include "plant_sim/study/robust/soonest.hpp"
#include "plant_sim/study/run_many.hpp"
#include "plant_sim/study/team/shared_work.hpp"
#include "plant_sim/study/team/team.hpp"
#include "rig_bridge/rig/load_rig.hpp"

namespace robust {

namespace {

using antiskid::control::Law;

ComparedLaw peer_of(const std::string& word) {
    if (word == "slip") return {.name = word, .law = Law::wheel_slip};
    if (word == "peak_slip") return {.name = word, .law = Law::peak_slip, .holds_peak = true};
    if (word == "threshold") return {.name = word, .law = Law::threshold};
    if (word == "pressure_bias") return {.name = word, .law = Law::pressure_bias};
    if (word == kToldPeak || is_bound(word)) return {.name = word, .law = Law::wheel_slip, .holds_peak = true};
    throw std::invalid_argument("unknown law '" + word + "'; there are slip, peak_slip, threshold, pressure_bias, told_peak, soonest, wary");
}

/// Limited to the references that the controller accepts.
double peak_slip(const rig::Surface& surface) {
    return std::min(rig::peak(surface).slip, static_cast<double>(antiskid::control::kMaxSlipReference));
}

Family family_of(const std::string& word) {
    const auto at = std::find(kFamilyNames.begin(), kFamilyNames.end(), word);
    if (at != kFamilyNames.end()) return static_cast<Family>(at - kFamilyNames.begin());
    std::string known;
    for (const std::string_view name : kFamilyNames) known += (known.empty() ? "" : ", ") + std::string(name);
    throw std::invalid_argument("unknown family '" + word + "'; there are " + known);
}

/// Properties that must be equal in all processes of one campaign.
std::string identity_of(const RobustPlan& plan) {
    std::string text = fmt::format("{} {} {} {}", ANTISKID_VERSION, plan.config_hash, plan.seed, plan.draws);
    for (const Family family : plan.families) text.append(" ").append(name(family));
    for (const ComparedLaw& law : plan.laws) text.append(" ").append(law.name);
    return text;
}

DrawnStop row_of(const RobustPlan& plan, std::size_t stop) {
    auto family = plan.families.begin();
    for (; stop >= plan.draws_of(*family) * plan.laws.size(); ++family) stop -= plan.draws_of(*family) * plan.laws.size();
    return DrawnStop{
        .family = *family, .law = stop / plan.draws_of(*family), .number = stop % plan.draws_of(*family), .figures = {}, .faults = {}, .regrip = {}};
}

/// A stop as it is sent between processes: as bytes, since all run the same program.
struct Finished {
    std::size_t stop = 0;
    DrawnStop row;
};
static_assert(std::is_trivially_copyable_v<Finished>);

std::string bytes_of(const Finished& finished) {
    std::string text(sizeof finished, '\0');
    std::memcpy(text.data(), &finished, sizeof finished);
    return text;
}

Finished read(std::string_view text) {
    Finished finished;
    if (text.size() != sizeof finished) throw std::invalid_argument("another process is of another version of this program");
    std::memcpy(&finished, text.data(), sizeof finished);
    return finished;
}

/// Row of a bound, without simulation.
DrawnStop bound_of(const RobustPlan& plan, DrawnStop row) {
    const rig::RigParameters rig = grid_stop(plan.basis, row.family, row.number).rig;
    const double period_s = std::chrono::duration<double>(study::period_of(plan.controller)).count();
    if (row.family == Family::changes) {
        const SurfaceChange change = change_at(plan.basis, row.number);
        const SoonestRegrip soonest = soonest_regrip(rig, plan.basis.landings[change.to].rig.surface, change.speed_mps, period_s);
        row.regrip = soonest.regrip;
        row.figures.j_mu = soonest.j_mu;
    } else {
        const std::string& law = plan.laws[row.law].name;
        const double slip = peak_slip(rig.surface);
        constexpr double kLate_s = 0.02;
        row.figures.j_mu = law == kSoonest ? soonest_j_mu(rig, plan.controller.slip, slip, plan.drop_out_mps, period_s)
                                           : wary_j_mu(rig, plan.controller.slip, slip, plan.drop_out_mps, period_s, kLate_s);
    }
    return row;
}

void run_share(const RobustPlan& plan, const std::vector<std::size_t>& share, const RunOptions& options, const study::team::PieceDone& piece_done) {
    std::vector<std::size_t> stops;
    for (const std::size_t stop : share) {
        const DrawnStop row = row_of(plan, stop);
        if (is_bound(plan.laws[row.law].name))
            piece_done(bytes_of({.stop = stop, .row = bound_of(plan, row)}));
        else
            stops.push_back(stop);
    }
    std::vector<std::shared_ptr<RegripMeter>> meters(stops.size());
    study::run_many(
        plan.layout, stops.size(),
        [&](std::size_t i) {
            const DrawnStop row = row_of(plan, stops[i]);
            study::Maneuver maneuver{plan.controller, draw(plan.basis, row.family, plan.seed, row.number).rig,
                                     session(plan, plan.laws[row.law], row.number)};
            if (row.family != Family::changes) return maneuver;
            const auto meter = meters[i] = std::make_shared<RegripMeter>(std::chrono::duration<double>(study::period_of(plan.controller)).count());
            maneuver.on_step = [meter](const study::RigSession& s, const antiskid::can::ControllerView&, double) {
                if (s.pilot().phase() == study::StopPhase::braking) meter->update(s.rig().surface(), s.rig().wheel().v_mps, s.rig().forces().mu);
            };
            return maneuver;
        },
        [&](std::size_t i, const study::RunResult& result) {
            Finished finished{.stop = stops[i], .row = row_of(plan, stops[i])};
            finished.row.figures = result.figures;
            finished.row.faults = result.faults;
            if (meters[i]) finished.row.regrip = meters[i]->regrip();
            piece_done(bytes_of(finished));
        },
        {.threads = options.threads, .stop = options.stop});
}

}  // namespace

RobustPlan load_plan(const RobustPlanOptions& o) {
    const auto or_default = [&](const std::filesystem::path& given, const char* name) { return given.empty() ? o.config / name : given; };
    const auto ranges = or_default(o.ranges, "uncertainty.toml");
    const auto controller = or_default(o.controller, "controller.toml");
    // Loaded before: GCC 12 destroys the members of a braced aggregate twice when a later one throws.
    const auto config = antiskid::load_controller_config(controller);
    const auto layout = antiskid::LayoutFiles(o.config).load(antiskid::required_range(config));
    RobustPlan plan{.basis = {.uncertainty = load_uncertainty(ranges), .landings = {}, .surfaces = {}},
                    .controller = config,
                    .layout = layout,
                    .families = {},
                    .laws = {},
                    .draws = o.draws,
                    .seed = o.seed,
                    .config_hash = {}};
    for (const std::string& word : o.families) plan.families.push_back(family_of(word));
    for (const std::string& word : o.laws) plan.laws.push_back(peer_of(word));
    const auto drawn = [](Family family) { return static_cast<std::size_t>(family) < kDrawnFamilies; };
    const auto changes = [](Family family) { return family == Family::changes; };
    const auto asks = [&o](std::string_view law) { return std::find(o.laws.begin(), o.laws.end(), law) != o.laws.end(); };
    const auto has = [&plan](const auto& any) { return std::any_of(plan.families.begin(), plan.families.end(), any); };
    if (asks(kSoonest) && has(drawn)) throw std::invalid_argument("soonest is of the families changes and brake_on alone");
    if (asks(kWary) && (has(drawn) || has(changes))) throw std::invalid_argument("wary is of the family brake_on alone");
    std::vector<std::filesystem::path> files{ranges, controller};
    for (const std::string& surface : rig::surface_names(o.config)) {
        for (const char* maneuver : {"light", "heavy"}) {
            rig::ManeuverChoice choice;
            choice.surface = surface;
            choice.maneuver = maneuver;
            const rig::LoadedRig loaded = rig::load_rig(o.config, choice);
            if (surface != "ice") plan.basis.landings.push_back({surface, maneuver, loaded.rig});
            plan.drop_out_mps = loaded.drop_out_mps;
            plan.demand_Pa = loaded.full_pressure_Pa;
            if (plan.basis.landings.size() == 1) files.insert(files.end(), loaded.files.begin(), loaded.files.end());
            if (maneuver == std::string("light")) plan.basis.surfaces.push_back(loaded.rig.surface);
        }
    }
    for (const rig::Surface& surface : plan.basis.surfaces)
        if (surface.magic && (asks(kSoonest) || asks(kWary)))
            throw std::invalid_argument("soonest and wary need surfaces by eq. (4); '" + surface.name + "' is a magic_formula");
    plan.config_hash = settings::hash(files);
    return plan;
}

std::size_t RobustPlan::draws_of(Family family) const {
    const std::size_t grid = grid_size(basis, family);
    return grid > 0 ? grid : draws;
}

std::size_t RobustPlan::stops() const {
    std::size_t all = 0;
    for (const Family family : families) all += laws.size() * draws_of(family);
    return all;
}

std::optional<double> held_slip(const RobustPlan& plan, const ComparedLaw& law, const rig::Surface& surface) {
    if (!antiskid::control::holds_slip(law.law)) return std::nullopt;
    return law.holds_peak ? peak_slip(surface) : plan.basis.uncertainty.slip_reference;
}

study::SessionOptions session(const RobustPlan& plan, const ComparedLaw& law, std::size_t number) {
    study::SessionOptions s;
    s.plan.law = law.law;
    if (law.law == Law::wheel_slip && law.holds_peak) s.slip_reference = [](const plant::Rig& rig) { return peak_slip(rig.surface()); };
    s.plan.slip_reference = plan.basis.uncertainty.slip_reference;
    s.plan.demand_Pa = plan.demand_Pa;
    s.period_s = static_cast<double>(plan.controller.period_s);
    s.drop_out_mps = plan.drop_out_mps;
    s.seed = plan.seed + number;
    return s;
}

std::vector<DrawnStop> run(const RobustPlan& plan, const RunOptions& options, study::team::Team& team) {
    const std::string identity = identity_of(plan);
    if (team.from_leader(identity) != identity) throw std::invalid_argument("this process was given other stops than the leading one");
    const std::vector<std::size_t> ours = study::team::share_of(study::team::order_of_work(plan.stops()), team);
    std::vector<std::optional<DrawnStop>> rows(plan.stops());
    std::size_t done = 0;
    study::team::work_together(
        team, [&](const study::team::PieceDone& piece_done) { run_share(plan, ours, options, piece_done); },
        [&](std::string_view text) {
            const Finished finished = read(text);
            rows.at(finished.stop) = finished.row;
            if (options.progress) options.progress(++done);
        });
    std::vector<DrawnStop> finished;
    for (const std::optional<DrawnStop>& row : rows)
        if (row) finished.push_back(*row);
    return finished;
}

std::vector<DrawnStop> run(const RobustPlan& plan, const RunOptions& options) {
    study::team::SingleProcess team;
    return run(plan, options, team);
}

}  // namespace robust
