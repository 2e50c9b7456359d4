#include "plant_sim/study/pilot.hpp"
#include "tests/catch.hpp"

using study::Pilot;
using study::StopPhase;

namespace {
study::ManeuverPlan plan() {
    study::ManeuverPlan p;
    p.demand_Pa = 20.7e6;
    return p;
}
}  // namespace

TEST_CASE("a landing goes through its phases once, in order", "[STUDY-030]") {
    Pilot pilot(plan());
    CHECK_FALSE(pilot.command().arm);
    CHECK_FALSE(pilot.command().weight_on_wheels);
    pilot.update(0.2, false);
    CHECK(pilot.command().arm);
    CHECK(pilot.command().demand_Pa == 0.0F);
    pilot.update(0.5, false);
    CHECK(pilot.phase() == StopPhase::rolling);
    CHECK(pilot.command().weight_on_wheels);
    CHECK(pilot.command().demand_Pa == 0.0F);
    pilot.update(1.5, false);
    CHECK(pilot.phase() == StopPhase::braking);
    CHECK(pilot.command().demand_Pa == 20.7e6F);
    pilot.update(9.0, true);
    CHECK(pilot.phase() == StopPhase::standstill);
    CHECK(pilot.command().demand_Pa == 20.7e6F);
    pilot.update(9.1, true);
    CHECK(pilot.phase() == StopPhase::released);
    CHECK(pilot.command().demand_Pa == 0.0F);
    CHECK_FALSE(pilot.command().arm);
    pilot.update(9.2, true);
    CHECK(pilot.phase() == StopPhase::done);
}

TEST_CASE("standing before brake-on ends nothing", "[STUDY-030]") {
    Pilot pilot(plan());
    pilot.update(0.1, true);
    CHECK(pilot.phase() == StopPhase::approach);
    pilot.update(0.6, true);
    CHECK(pilot.phase() == StopPhase::rolling);
}

TEST_CASE("the open-loop profile counts from brake-on, linear between points, held beyond", "[STUDY-030]") {
    study::ManeuverPlan p = plan();
    p.law = antiskid::control::Law::open_loop;
    p.current = {{0.0, 4.0}, {1.0, 10.0}, {2.0, 10.0}};
    Pilot pilot(p);
    pilot.update(1.0, false);
    CHECK(pilot.command().current_mA == 0.0F);
    pilot.update(1.5, false);
    CHECK(pilot.command().current_mA == Approx(4.0F).margin(1e-6));
    pilot.update(2.0, false);
    CHECK(pilot.command().current_mA == Approx(7.0F).margin(1e-5));
    pilot.update(30.0, false);
    CHECK(pilot.command().current_mA == Approx(10.0F));
}
