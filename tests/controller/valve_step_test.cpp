// The small step of the valve: a healthy one answers, a sick one is named, and whatever happens on the way ends at the safe current.
#include "firmware/controller/valve_step.hpp"

#include <functional>

#include "firmware/control/valve_model.hpp"
#include "tests/controller/results.hpp"
#include "tests/controller/rig_at_rest.hpp"

using namespace controller_test;
using namespace std::chrono_literals;
using controller::ValveStep;

namespace {

struct Valve {
    float gain = 1.0F;
    double slower = 1.0;  ///< bandwidth and delay
    float leak_Pa = 0.0F;
    bool sticks = false;  ///< once it is open
};

struct Played {
    controller::Check check;
    float max_current_mA = 0.0F;
    float max_Pa = 0.0F;
    float last_current_mA = -1.0F;
    int periods = 0;
};

using Change = std::function<void(control::Sensors&, int period)>;

Played play(const Valve& valve, const Change& change = {}) {
    const control::Config config = host_test::default_setup().control;
    control::ValveConfig sick = config.valve;
    sick.natural_frequency_radps = static_cast<float>(sick.natural_frequency_radps / valve.slower);
    sick.delay_s = static_cast<float>(std::min(15e-3, sick.delay_s * valve.slower));
    control::ValveModel model(sick, config.period_s, {});
    ValveStep step(config);
    Played played;
    control::Sensors sensors;
    float commanded = 0.0F;
    for (control::Time now = 7s; !step.over() && played.periods < 5000; now += 1ms) {
        const bool stuck = valve.sticks && played.periods > 300;
        if (!stuck) commanded = valve.gain * control::valve_pressure_Pa(config.valve, played.last_current_mA);
        model.update(std::max(0.0F, commanded), 0.0F, false);
        sensors.pressure.pressure_Pa = model.now().pressure_Pa + valve.leak_Pa;
        sensors.wheel.received = sensors.flywheel.received = sensors.pressure.received = now;
        if (change) change(sensors, played.periods);
        played.last_current_mA = step.step(sensors, now);
        played.max_current_mA = std::max(played.max_current_mA, played.last_current_mA);
        played.max_Pa = std::max(played.max_Pa, sensors.pressure.pressure_Pa);
        ++played.periods;
    }
    CHECK(step.over());
    played.check = step.result();
    return played;
}

bool fails_by(const Played& played, const std::string& words) {
    return played.check.verdict == controller::CheckResult::fail && played.check.measured.find(words) != std::string::npos;
}

}  // namespace

TEST_CASE("a healthy valve answers; the step is small, short and ends at the safe current", "[RT-130]") {
    const Played played = play({});
    CAPTURE(played.check.measured);
    CHECK(played.check.verdict == controller::CheckResult::pass);
    CHECK(played.last_current_mA == 0.0F);
    CHECK(played.max_current_mA < 8.0F);
    CHECK(played.max_Pa < 1.2e6F);
    CHECK(played.periods < 700);
    CHECK(play({.gain = 1.2F}).check.verdict == controller::CheckResult::pass);
    CHECK(play({.gain = 0.8F}).check.verdict == controller::CheckResult::pass);
}

TEST_CASE("a valve that answers too much, too little, too late or not at all fails", "[RT-130]") {
    CHECK(play({.gain = 1.35F}).check.verdict == controller::CheckResult::fail);
    CHECK(play({.gain = 0.7F}).check.verdict == controller::CheckResult::fail);
    CHECK(play({.gain = 0.0F}).check.verdict == controller::CheckResult::fail);
    CHECK(play({.slower = 6.0}).check.verdict == controller::CheckResult::fail);
    CHECK(play({.leak_Pa = 0.45e6F}).check.verdict == controller::CheckResult::fail);
    CHECK(play({.sticks = true}).check.verdict == controller::CheckResult::fail);
    CHECK(fails_by(play({.gain = 3.0F}), "twice what was asked"));
}

TEST_CASE("whatever moves, stops or falls silent during the step ends it at once at the safe current", "[RT-130]") {
    const auto at = [](int when, const std::function<void(control::Sensors&)>& what) {
        return [when, what](control::Sensors& sensors, int period) {
            if (period >= when) what(sensors);
        };
    };
    const std::vector<std::pair<Change, std::string>> alarms{
        {at(100, [](auto& s) { s.wheel.edge_count = 1; }), "the wheel turns"},
        {at(100, [](auto& s) { s.flywheel.speed_radps = 1.0F; }), "the flywheel turns"},
        {at(100, [](auto& s) { s.emergency_stop = true; }), "emergency stop"},
        {at(100, [](auto& s) { s.bus_off = true; }), "the link is down"},
        {at(100, [](auto& s) { s.pressure.received -= 25ms; }), "a sensor fell silent"},
        {at(100, [](auto& s) { s.wheel.received = control::kNever; }), "a sensor fell silent"},
        {at(100, [](auto& s) { s.pressure.pressure_Pa = std::nanf(""); }), "twice what was asked"},
        {at(0, [](auto& s) { s.emergency_stop = true; }), "emergency stop"},
    };
    for (const auto& [change, words] : alarms) {
        const Played played = play({}, change);
        CAPTURE(words, played.check.measured);
        CHECK(fails_by(played, words));
        CHECK(played.last_current_mA == 0.0F);
        CHECK(played.periods <= 101);
    }
}
