/// Gains of the shipped law are judged by their stops, then by their margins; what is asked for decides how much of that is done.
#include "plant_sim/study/margins/law_judge.hpp"

#include <algorithm>
#include <limits>

#include "plant_sim/scenario/stop_options.hpp"
#include "tests/catch.hpp"

using namespace study::margins;
using antiskid::control::Config;

namespace {

constexpr double kNothing = -std::numeric_limits<double>::infinity();

/// Two short stops, of which the first decides on the second.
struct Bench {
    std::vector<plant_sim::StopInputs> loaded;
    std::vector<StopConditions> scenarios;
    TrialStops trial;

    Bench() {
        for (const char* surface : {"dry_concrete", "wet_asphalt"}) {
            plant_sim::StopOptions o;
            o.choice.surface = surface;
            o.choice.maneuver = "light";
            loaded.push_back(plant_sim::load_scenario(o));
            const auto& p = loaded.back().plant;
            scenarios.push_back({surface, "light", p.rig, p.drop_out_mps, p.full_pressure_Pa});
            trial.groups.emplace_back(surface);
            trial.surfaces = trial.groups.size();
            trial.stops.push_back({trial.groups.size() - 1, p.rig, loaded.back().session});
        }
        trial.layout = &loaded.front().layout;
        trial.first = 1;
        trial.min_j_mu = {0.9, 0.9};
        trial.requirement = {.mean_j_mu = 0.9, .longest_lock_s = 0.05, .tracked_share = 0.95};
    }
    [[nodiscard]] const Config& controller() const { return loaded.front().controller; }
};

}  // namespace

TEST_CASE("stops are judged by friction, each surface's too, and cut short where they cannot pass", "[STUDY-561]") {
    Bench b;
    const StopsShown good = make_stops(b.trial, b.controller(), 0.0);
    CHECK(good.whole);
    CHECK(good.violation == 0.0);
    CHECK(good.mean_j_mu == Approx(0.5 * (good.group_j_mu[0] + good.group_j_mu[1])));
    CHECK(good.mean_j_mu > 0.95);

    b.trial.min_j_mu[1] = good.group_j_mu[1] + 0.01;
    CHECK(make_stops(b.trial, b.controller(), 1.0).violation == Approx(0.005));
    b.trial.min_j_mu = {good.group_j_mu[0] + 0.02, 0.9};
    const StopsShown cut = make_stops(b.trial, b.controller(), 0.0);
    CHECK_FALSE(cut.whole);
    CHECK(cut.violation == Approx(0.01));
    b.trial.min_j_mu[0] = 0.9;
    b.trial.requirement.mean_j_mu = good.mean_j_mu + 0.003;
    CHECK(make_stops(b.trial, b.controller(), 1.0).violation == Approx(0.003));
    b.trial.requirement.mean_j_mu = 0.9;

    Config loose = b.controller();  // hardly any gain: the slip is not held
    loose.slip.k_p_per_s = 1.0F;
    loose.slip.k_d = 0.0F;
    loose.slip.k_dd_s = 0.0F;
    const StopsShown bad = make_stops(b.trial, loose, 100.0);
    REQUIRE(bad.min_tracked);
    CHECK(*bad.min_tracked < 0.95);
    CHECK(bad.violation >= 0.95 - *bad.min_tracked);
}

TEST_CASE("tracking that no stop measured is missing, not perfect", "[STUDY-561]") {
    Bench b;
    for (TrialStop& stop : b.trial.stops) {  // below 20 m/s none is measured
        stop.rig.brake_on_mps = 15.0;
        stop.rig.touchdown_mps = 0.0;
    }
    const StopsShown shown = make_stops(b.trial, b.controller(), 100.0);
    CHECK_FALSE(shown.min_tracked);
    CHECK(shown.violation >= b.trial.requirement.tracked_share);
}

TEST_CASE("a score says stops, stability and margins, in this order, whatever is to be beaten", "[STUDY-561]") {
    Bench b;
    StudyOptions options;
    options.speeds = 3;
    const LawJudge judge(b.scenarios, b.trial, options);
    const Config& good = b.controller();
    const double exact = judge.score(good, kNothing);
    CHECK(exact > 0.0);
    CHECK(exact == judge.margins_of(good).value);
    CHECK(judge.margins_of(good).counted == 6);
    for (const double to_beat : {-3.0, -0.5, 0.0, exact}) CHECK(judge.score(good, to_beat) == exact);
    CHECK(judge.score(good, exact + 0.01) < exact + 0.01);

    Config unstable = good;  // the stops pass
    unstable.slip.low_speed_mps = 0.0F;
    const double share = judge.score(unstable, kNothing);
    CHECK(share < 0.0);
    CHECK(share >= -1.0);
    CHECK(share == judge.margins_of(unstable).value);
    CHECK(judge.score(unstable, 0.0) < 0.0);

    Config alone = good;  // the closed loop is stable, the law by itself is not
    alone.estimator.valve_offset_radps = 0.0F;
    alone.slip.k_p_per_s = 400.0F;
    alone.slip.k_d = 10.5F;
    alone.slip.k_dd_s = 0.0123F;
    CHECK(judge.margins_of(alone).unstable > 0);
    CHECK(judge.score(alone, kNothing) < 0.0);

    b.trial.requirement.mean_j_mu = 1.0;
    CHECK(judge.score(good, kNothing) == Approx(-2.0 - (1.0 - make_stops(b.trial, good, 1.0).mean_j_mu)));
    CHECK(judge.score(good, 0.0) < 0.0);
}

TEST_CASE("gains go into the controller by name and come back", "[STUDY-561]") {
    const Bench b;
    std::vector<double> values = gains_of(b.controller());
    REQUIRE(values.size() == gain_names().size());
    for (double& v : values) v *= 2.0;
    CHECK(gains_of(with_gains(b.controller(), values)) == values);
    const std::vector<std::string> names = gain_names();
    const auto at = std::find(names.begin(), names.end(), "k_dd_s") - names.begin();
    CHECK(values[static_cast<std::size_t>(at)] == 2.0 * static_cast<double>(b.controller().slip.k_dd_s));
}
