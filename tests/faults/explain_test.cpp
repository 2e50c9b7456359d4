/// What a stop shows of itself: a sound one nothing, one whose encoder is off what it is off by.
#include "plant_sim/study/faults/explain.hpp"

#include <vector>

#include "plant_sim/study/robust/robust_campaign.hpp"
#include "tests/catch.hpp"

using namespace faults;

namespace {

const FaultPlan& plan() {
    static const FaultPlan loaded = load_plan({});
    return loaded;
}

/// A run of the campaign with another fault.
Case with(std::size_t number, Fault fault) {
    Case c = plan().at(number);
    c.fault = fault;
    return c;
}

constexpr ExplainOptions kFew{.twins = 4, .rigs = 4};
constexpr std::size_t kFastOnAsphalt = 1720;  // begins at 25 to 45 m/s

const robust::Basis& basis() {
    static const robust::Basis loaded = robust::load_plan({}).basis;
    return loaded;
}

double measured(const Explanation& e, Symptom symptom) {
    return e.symptoms[static_cast<std::size_t>(symptom)];
}
bool shown(const Explanation& e, Symptom symptom) {
    return e.twins[static_cast<std::size_t>(symptom)].shows(measured(e, symptom));
}

}  // namespace

TEST_CASE("explain: a stop whose fault never comes is as long as the sound one, on the whole of its friction", "[RIG-710]") {
    REQUIRE(plan().at(kFastOnAsphalt).phase == StopPart::fast);
    const Explanation e = explain(plan(), with(kFastOnAsphalt, {.what = {Signal::wheel, Kind::bias}, .lasts_s = 0.0}), basis(), {.rigs = 4});
    CHECK(e.result.verdict.distance_share == Approx(1.0).margin(1e-6));
    CHECK(e.grip == 1.0);
    CHECK(e.twin_share == e.result.verdict.distance_share);
    for (std::size_t i = 0; i < kSymptomNames.size(); ++i) {
        INFO(kSymptomNames[i]);
        CHECK_FALSE(e.twins[i].shows(e.symptoms[i]));
    }
}

TEST_CASE("explain: what an encoder is off by is seen where it is, and a longer stop has a sound one as long", "[RIG-710]") {
    const Fault noise{.what = {Signal::wheel, Kind::noise}, .strength = 0.9, .lasts_s = 0.4};
    const Explanation e = explain(plan(), with(kFastOnAsphalt, noise), basis(), kFew);
    CHECK(shown(e, Symptom::wild));
    CHECK(shown(e, Symptom::scatter));
    CHECK_FALSE(shown(e, Symptom::refused));
    CHECK(measured(e, Symptom::wild) > 5.0);
    REQUIRE(e.result.verdict.outcome != Outcome::safe);
    REQUIRE(e.result.verdict.distance_share > 1.02);
    CHECK(e.grip < 1.0);
    CHECK(e.twin_share == Approx(e.result.verdict.distance_share).epsilon(0.02));
}

TEST_CASE("explain: frames that are late and commands that come late are seen as late as they are", "[RIG-710]") {
    const Explanation wheel =
        explain(plan(), with(kFastOnAsphalt, {.what = {Signal::wheel, Kind::jitter}, .strength = 0.3, .lasts_s = 0.3}), basis(), kFew);
    CHECK(shown(wheel, Symptom::late));
    CHECK(measured(wheel, Symptom::late) > 2e-3);
    const Fault late{.what = {Signal::valve_command, Kind::delay}, .strength = 0.5, .lasts_s = Fault::kForGood};
    const Explanation valve = explain(plan(), with(kFastOnAsphalt, late), basis(), kFew);
    CHECK(shown(valve, Symptom::lag));
    CHECK(measured(valve, Symptom::lag) > 1e-3);
    CHECK_FALSE(shown(valve, Symptom::refused));
}

TEST_CASE("explain: the impulse of the road over the speed lost is the aircraft's mass, as the brake is known", "[RIG-710]") {
    const Explanation e = explain(plan(), with(kFastOnAsphalt, {.what = {Signal::wheel, Kind::bias}, .lasts_s = 0.0}), basis(), kFew);
    // k_b falls with the energy that the brake has taken: the controller reckons with a new one.
    CHECK(measured(e, Symptom::mass) == Approx(plan().surfaces[0].rig.wheel.mass_kg).epsilon(0.15));
    const std::vector<Explanation> one{e};
    CHECK(to_json(plan(), one).find("\"mass_kg\"") != std::string::npos);
    CHECK(to_table(plan(), one).find("run 1720") != std::string::npos);
}
