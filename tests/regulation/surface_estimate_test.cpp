/// Whether the controller's estimate of peak slip and grip (law peak_slip) tells the surface early in a stop, and what references by it are worth
/// against a report of the surface. Figures: test_regulation_stops '[STUDY-172]' -s
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "plant_sim/lab/regulate_stops.hpp"
#include "plant_sim/study/run_many.hpp"
#include "rig_bridge/wear/surface_references.hpp"
#include "tests/catch.hpp"

namespace {

/// What is known half a second after the law began to search.
struct EarlyEstimate {
    std::size_t surface = 0;         // the true one
    double peak_slip = 0.0;          // estimated
    double log_grip = 0.0;           // of the friction force over the load, times the brake's friction, which the estimate takes as constant
    double part = 0.0, share = 0.0;  // of the stop's energy gone so far; the tyre's share of that
};

/// All landings of the configuration with a new brake and a worn one.
std::vector<EarlyEstimate> early_estimates(const plant_sim::lab::LandingSites& sites, const wear::SurfaceTable& table, std::uint64_t seed,
                                           const std::array<double, 2>& frictions) {
    constexpr double kAfter_s = 0.5;
    std::vector<EarlyEstimate> all(sites.sites.size() * frictions.size());
    const auto make = [&](std::size_t i) {
        const plant_sim::lab::LandingSite& site = sites.sites[i % sites.sites.size()];
        study::Maneuver m{.controller = sites.controller, .rig = site.rig.rig, .options = {}};
        m.rig.mean_friction = frictions.at(i / sites.sites.size());
        m.options.plan.law = antiskid::control::Law::peak_slip;
        m.options.plan.slip_reference = 0.24;
        m.options.plan.demand_Pa = site.rig.full_pressure_Pa;
        m.options.period_s = static_cast<double>(sites.controller.period_s);
        m.options.drop_out_mps = site.rig.drop_out_mps;
        m.options.seed = seed;
        all[i].surface = static_cast<std::size_t>(table.find(site.surface) - table.rows.data());
        m.on_step = [&one = all[i], &site, friction = m.rig.mean_friction, begin_s = -1.0](
                        const study::RigSession& session, const antiskid::can::ControllerView& view, double) mutable {
            if (begin_s < 0.0 && view.road.confidence > 0.0F) begin_s = session.rig().time_s();
            if (begin_s < 0.0 || one.part > 0.0 || session.rig().time_s() < begin_s + kAfter_s) return;
            one.peak_slip = static_cast<double>(view.road.peak_slip);
            const double load_N = static_cast<double>(session.load_cells().vertical_N);
            one.log_grip = std::log(std::max(1.0, static_cast<double>(view.road.grip_N)) / load_N * friction);
            const plant::WheelState& wheel = session.rig().wheel();
            one.part = (wheel.energy_tyre_J + wheel.energy_brake_J) / site.kinetic_J();
            one.share = wheel.energy_tyre_J / (wheel.energy_tyre_J + wheel.energy_brake_J);
        };
        return m;
    };
    study::run_many(sites.layout, all.size(), make, [](std::size_t, const study::RunResult&) {}, {.threads = 2});
    return all;
}

struct Normal {
    double mean = 0.0, deviation = 0.0;
};

Normal normal_of(const std::vector<EarlyEstimate>& seen, std::size_t surface, double EarlyEstimate::*value, double least_deviation) {
    double count = 0.0, sum = 0.0, squares = 0.0;
    for (const EarlyEstimate& one : seen) {
        if (one.surface != surface) continue;
        count += 1.0;
        sum += one.*value;
        squares += one.*value * one.*value;
    }
    const double mean = sum / count;
    return {mean, std::max(least_deviation, std::sqrt(std::max(0.0, squares / count - mean * mean)))};
}

/// The most probable surface, all equally probable before, by independent normal distributions.
class Recognition {
  public:
    Recognition(const std::vector<EarlyEstimate>& learnt_from, std::size_t surfaces) {
        slip_.reserve(surfaces);
        grip_.reserve(surfaces);
        for (std::size_t s = 0; s < surfaces; ++s) {
            slip_.push_back(normal_of(learnt_from, s, &EarlyEstimate::peak_slip, 0.004));
            grip_.push_back(normal_of(learnt_from, s, &EarlyEstimate::log_grip, 0.03));
        }
    }
    [[nodiscard]] std::size_t surface(const EarlyEstimate& seen) const {
        const auto unlikely = [](double value, const Normal& n) { return std::pow((value - n.mean) / n.deviation, 2) / 2.0 + std::log(n.deviation); };
        std::size_t best = 0;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t s = 0; s < slip_.size(); ++s) {
            const double here = unlikely(seen.peak_slip, slip_[s]) + unlikely(seen.log_grip, grip_[s]);
            if (here < least) {
                least = here;
                best = s;
            }
        }
        return best;
    }

  private:
    std::vector<Normal> slip_, grip_;
};

}  // namespace

TEST_CASE("half a second after the search began the controller's estimate tells the surface, but for dry asphalt from dry concrete", "[STUDY-172]") {
    const plant_sim::lab::LandingSites sites = plant_sim::lab::load_sites("config");
    const wear::RegulationConfig config = wear::load_regulation_config("config/regulation.toml");
    const wear::SurfaceTable& table = config.floor;
    const std::size_t surfaces = table.rows.size();
    std::vector<EarlyEstimate> learnt = early_estimates(sites, table, 1, {0.30, 0.22});
    const std::vector<EarlyEstimate> more = early_estimates(sites, table, 2, {0.30, 0.22});
    learnt.insert(learnt.end(), more.begin(), more.end());
    const Recognition recognition(learnt, surfaces);

    // Judged with other seeds and brakes. The brake's friction is known from the landing before, to 3 %.
    std::vector<std::vector<double>> seen_as(surfaces, std::vector<double>(surfaces, 0.0));
    std::vector<double> part(surfaces, 0.0), early_share(surfaces, 0.0);
    double count = 0.0, recognised = 0.0, dry = 0.0;
    const auto dry_pair = [&](std::size_t s) { return table.rows[s].surface == "dry_asphalt" || table.rows[s].surface == "dry_concrete"; };
    for (const std::uint64_t seed : {std::uint64_t{21}, std::uint64_t{22}}) {
        for (EarlyEstimate one : early_estimates(sites, table, seed, {0.27, 0.20})) {
            REQUIRE(one.part > 0.0);
            const double each = 1.0 / 32.0;  // of a surface's landings: 2 seeds, 2 brakes, 4 maneuvers, 2 errors
            part[one.surface] += 2.0 * each * one.part;
            early_share[one.surface] += 2.0 * each * one.share;
            for (const double error : {-0.03, 0.06}) {
                one.log_grip += error;
                const std::size_t seen = recognition.surface(one);
                seen_as[one.surface][seen] += each;
                count += 1.0;
                recognised += seen == one.surface ? 1.0 : 0.0;
                dry += seen != one.surface && dry_pair(seen) && dry_pair(one.surface) ? 1.0 : 0.0;
            }
        }
    }
    CAPTURE(recognised, dry, count);
    CHECK(recognised > 0.9 * count);
    CHECK(recognised + dry > 0.98 * count);

    // What references by it are worth, at the mean tyre share of one reference of 0.24, all surfaces equally probable.
    const wear::SurfaceReferences references(table, config.rules.j_mu_floor, config.rules.default_reference);
    struct Means {
        double share = 0.0, distance_m = 0.0, relative = 0.0, least_j_mu = 1.0;
    };
    const auto with = [&](double mean_share, bool told) {
        Means m;
        const double each = 1.0 / static_cast<double>(surfaces);
        for (std::size_t s = 0; s < surfaces; ++s) {
            const wear::SurfaceTable::Row& row = table.rows[s];
            for (std::size_t seen = 0; seen < surfaces; ++seen) {
                const double p = each * (told ? (seen == s ? 1.0 : 0.0) : seen_as[s][seen]);
                if (p == 0.0) continue;
                const double reference = references.reference(seen, mean_share);
                const double early = told ? 0.0 : part[s];  // of the stop's energy, at the slip of the search
                m.share += p * (early * early_share[s] + (1.0 - early) * table.at(row.tyre_share, reference));
                m.distance_m += p * table.at(row.distance_m, reference);
                m.relative += p * table.at(row.distance_m, reference) / table.at(row.distance_m, config.rules.default_reference);
                m.least_j_mu = std::min(m.least_j_mu, table.at(row.j_mu, reference));
            }
        }
        return m;
    };
    const double share = references.default_share();
    const wear::Range range = references.shares();
    double low = range.lowest, high = range.highest;  // of the mean share for the rest of the stop
    while (high - low > 1e-6) (with((low + high) / 2.0, false).share < share ? low : high) = (low + high) / 2.0;
    const Means told = with(share, true), estimated = with(low, false);
    double one_reference_m = 0.0;
    for (const wear::SurfaceTable::Row& row : table.rows)
        one_reference_m += table.at(row.distance_m, config.rules.default_reference) / static_cast<double>(surfaces);
    CAPTURE(share, one_reference_m, told.distance_m, told.relative, estimated.distance_m, estimated.relative, estimated.least_j_mu);
    CAPTURE(range.lowest, with(range.lowest, false).share, range.highest, with(range.highest, false).share, with(range.lowest, false).least_j_mu,
            with(range.highest, false).least_j_mu);
    CHECK(estimated.share == Approx(share).epsilon(1e-4));
    // At least two thirds of what a report saves.
    CHECK(one_reference_m - estimated.distance_m > (one_reference_m - told.distance_m) * 2.0 / 3.0);
    CHECK(estimated.least_j_mu > config.rules.j_mu_floor - 0.01);
}
