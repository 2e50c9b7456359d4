/// step() in the real-time path: traps in front of the C library count what it must not do.
#include "tests/catch.hpp"
#include "tests/host/traps.hpp"
#include "tests/rig/rig_model.hpp"

using namespace sequencer_test;
namespace traps = host_test::traps;

TEST_CASE("a whole maneuver and an abort: no allocation, lock, print or exception in any step", "[BRG-100]") {
    const bool aborts = GENERATE(false, true);
    Plan plan = landing();
    plan.law = rig::BrakeLaw::open_loop;
    plan.current = {{0.0, 5.0}, {0.5, 10.0}, {1.0, 12.0}};
    rig::Sequencer s(plan);
    RigModel rig;
    traps::clear();
    int steps = 0;
    {
        const traps::Armed armed;
        for (double now = 0.0; now < 600.0 && !s.over(); now += kStep_s, ++steps) {
            if (aborts && s.phase() == Phase::braking) rig.inputs.guard_closed = false;
            rig.advance(s.step(rig.inputs, now), kStep_s);
        }
    }
    CHECK(s.over());
    CHECK(steps > 1000);
    CHECK(traps::caught() == 0);
}
