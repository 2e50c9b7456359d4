/// The valve's map, hysteresis and dynamics from recordings of the virtual rig, whose truth is known.
#include "plant_sim/study/identification/valve_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "plant_sim/study/identification/valve_response.hpp"
#include "tests/catch.hpp"
#include "tests/identification/experiments.hpp"

using identification::Estimate;
using identification::fit_valve;
using identification::KnownRig;
using identification::NotIdentifiable;
using identification::Recording;
using identification::ValveFit;
using identification_test::known;
using identification_test::record;

namespace {

/// The three experiments on a valve of these parameters, and of the shipped map with this gain.
std::vector<Recording> experiments(const rig::ValveParameters& valve, double gain, std::uint64_t seed) {
    std::vector<Recording> all;
    for (const char* name : {"ramp", "step", "sweep"}) {
        endurance::EnduranceSetup s = identification_test::setup(name);
        rig::RigParameters& rig = s.scenario.rig.rig;
        rig.valve = valve;
        auto points = rig.pressure_map.points();
        for (auto& point : points) point.pressure_Pa *= gain;
        rig.pressure_map = rig::PressureMap(points);
        all.push_back(record(s, seed));
    }
    return all;
}

KnownRig light_rig() {
    return known(identification_test::setup("ramp"));
}

/// As few misses as a correct interval gives with great probability.
struct Count {
    int hits = 0, all = 0;
    void check(const Estimate& e, double truth) {
        CHECK(std::abs(e.value - truth) < 5.0 * e.deviation);
        hits += e.contains(truth) ? 1 : 0;
        ++all;
    }
};

std::string rejection(const std::vector<Recording>& recordings, const KnownRig& rig) {
    try {
        (void)fit_valve(recordings, rig);
    } catch (const NotIdentifiable& e) {
        return e.what();
    }
    return "";
}

}  // namespace

TEST_CASE("map, hysteresis and dynamics of the valve are found, each within its interval", "[STUDY-100]") {
    struct Case {
        rig::ValveParameters valve;
        double gain;
    };
    constexpr double kTurn = 2.0 * std::numbers::pi;
    const Case c = GENERATE(Case{{.natural_frequency_radps = kTurn * 20.0, .damping = 0.8, .delay_s = 6e-3, .hysteresis_mA = 0.0}, 1.0},
                            Case{{.natural_frequency_radps = kTurn * 20.0, .damping = 0.8, .delay_s = 6e-3, .hysteresis_mA = 0.6}, 1.0},
                            Case{{.natural_frequency_radps = kTurn * 31.0, .damping = 0.55, .delay_s = 4.37e-3, .hysteresis_mA = 0.25}, 0.93});
    const ValveFit f = fit_valve(experiments(c.valve, c.gain, 11), light_rig());
    Count count;
    count.check(f.natural_frequency_Hz, c.valve.natural_frequency_radps / kTurn);
    count.check(f.damping, c.valve.damping);
    count.check(f.delay_s, c.valve.delay_s);
    count.check(f.hysteresis_mA, c.valve.hysteresis_mA);
    count.check(f.dead_zone_mA, 3.0);
    const auto truth = identification_test::setup("ramp").scenario.rig.rig.pressure_map.points();
    REQUIRE(f.pressure_Pa.size() == truth.size() - 1);
    for (std::size_t i = 0; i < f.pressure_Pa.size(); ++i) count.check(f.pressure_Pa[i], c.gain * truth[i + 1].pressure_Pa);
    CHECK(count.hits >= count.all - 2);
    // And they say something.
    CHECK(f.natural_frequency_Hz.deviation < 0.005 * f.natural_frequency_Hz.value);
    CHECK(f.hysteresis_mA.deviation < 0.005);
    CHECK(f.delay_s.deviation < 50e-6);
    CHECK(f.rms_Pa == Approx(20.0e3).epsilon(0.03));  // the gauge's noise, and nothing else
    CHECK(f.hysteresis_Pa.value == Approx(f.hysteresis_mA.value * c.gain * 0.62e6).epsilon(1e-3));
}

TEST_CASE("the modelled pressure is eq. (6), integrated by brute force", "[STUDY-100]") {
    const rig::PressureMap map({{3.0, 0.0}, {10.0, 4.0e6}, {40.0, 20.0e6}});
    const rig::ValveParameters valve{.natural_frequency_radps = 110.0, .damping = 0.6, .delay_s = 3.7e-3, .hysteresis_mA = 1.0};
    constexpr double kPeriod_s = 1e-3;
    std::vector<double> current_mA;
    for (int k = 0; k < 400; ++k) current_mA.push_back(k < 150 ? 20.0 : k < 250 ? 12.0 + 0.02 * k : 16.7);
    std::vector<double> pressure_Pa(current_mA.size());
    identification::valve_response(current_mA, kPeriod_s, map, valve, pressure_Pa);

    constexpr int kFine = 1000;
    double in_effect_mA = 0.0;
    std::vector<double> static_Pa;
    for (const double current : current_mA) {
        if (current - in_effect_mA > 0.5) in_effect_mA = current - 0.5;
        if (in_effect_mA - current > 0.5) in_effect_mA = current + 0.5;
        static_Pa.push_back(map.pressure_Pa(in_effect_mA));
    }
    double p = 0.0;
    double rate = 0.0;
    constexpr double h = kPeriod_s / kFine;
    for (int k = 0; k < 400; ++k) {
        CHECK(pressure_Pa[static_cast<std::size_t>(k)] == Approx(std::max(p, 0.0)).epsilon(2e-4).margin(1e3));
        for (int i = 0; i < kFine; ++i) {
            const double t = (k + (i + 0.5) / kFine) * kPeriod_s - valve.delay_s;
            const double u = t < 0.0 ? 0.0 : static_Pa[static_cast<std::size_t>(t / kPeriod_s)];
            rate += h * valve.natural_frequency_radps * (valve.natural_frequency_radps * (u - p) - 2.0 * valve.damping * rate);
            p += h * rate;
        }
    }
}

TEST_CASE("what the recordings do not show is refused with the experiment that is missing", "[STUDY-100]") {
    const rig::ValveParameters shipped = identification_test::setup("ramp").scenario.rig.rig.valve;
    static const std::vector<Recording> kAll = experiments(shipped, 1.0, 3);
    const auto says = [](const std::string& what) { return ContainsSubstring(what); };
    CHECK_THAT(rejection({}, light_rig()), says("ramp, step and sweep"));
    CHECK_THAT(rejection({kAll[1], kAll[2]}, light_rig()), says("config/scenarios/ramp.toml") && says("5, 8, 12"));
    CHECK_THAT(rejection({kAll[0]}, light_rig()), says("config/scenarios/step.toml"));

    KnownRig narrow = light_rig();
    narrow.map_currents.pop_back();
    CHECK_THAT(rejection(kAll, narrow), says("outside of the map") && says("--currents"));
    KnownRig gauge = light_rig();
    gauge.gauge_range_Pa = 15.0e6;
    std::vector<Recording> saturated = kAll;
    for (Recording& r : saturated) {
        for (auto& s : r.samples) s.pressure_Pa = std::min(s.pressure_Pa, gauge.gauge_range_Pa);
    }
    CHECK_THAT(rejection(saturated, gauge), says("saturates"));

    std::vector<Recording> broken = kAll;
    broken[1].samples[20000].pressure_Pa = NAN;
    CHECK_THAT(rejection(broken, light_rig()), says("step") && says("no number"));
    broken = kAll;
    std::swap(broken[2].samples[500].time_s, broken[2].samples[600].time_s);
    CHECK_THAT(rejection(broken, light_rig()), says("sweep") && says("time does not rise"));
    broken = kAll;
    auto& samples = broken[0].samples;
    samples.erase(samples.begin() + 50000, samples.begin() + 50200);
    CHECK_THAT(rejection(broken, light_rig()), says("ramp") && says("without samples"));
}

TEST_CASE("samples that are missing are bridged", "[STUDY-100]") {
    const rig::ValveParameters shipped = identification_test::setup("ramp").scenario.rig.rig.valve;
    std::vector<Recording> holes = experiments(shipped, 1.0, 4);
    for (Recording& r : holes) {
        for (std::size_t k = 40000 % r.samples.size(); k + 10 < r.samples.size(); k += 997)
            r.samples.erase(r.samples.begin() + static_cast<std::ptrdiff_t>(k));
    }
    const ValveFit f = fit_valve(holes, light_rig());
    CHECK(std::abs(f.delay_s.value - 6e-3) < 5.0 * f.delay_s.deviation);
    CHECK(std::abs(f.damping.value - 0.8) < 5.0 * f.damping.deviation);
}
