#include "rig_bridge/bridge/trace.hpp"

#include <algorithm>

#include "tests/catch.hpp"

using rig::Phase;

TEST_CASE("The trace runs from touchdown to retract and knows brake-on", "[BRG-420]") {
    rig::bridge::Trace trace;
    CHECK(trace.empty());
    rig::bridge::Moment m;
    m.plc.values.fill(7.0);
    for (int phase = 0; phase < rig::kPhaseCount; ++phase) {
        for (int i = 0; i < 10; ++i) {
            m.outputs.phase = static_cast<Phase>(phase);
            m.bus.rim_mps = 61.0;
            m.inputs.wheel_rim_mps = 46.36;
            m.bus.slip = 0.24;
            trace.record(m);
            m.rig_s += 0.01;
        }
    }
    const std::string csv = trace.csv();
    CHECK(std::count(csv.begin(), csv.end(), '\n') == 1 + 5 * 10);
    CHECK(csv.starts_with("time_s,speed_mps,wheel_rim_speed_mps,slip,"));
    CHECK_THAT(csv, ContainsSubstring("\n0.000,61.0000,46.3600,0.24000,0.00000,0,0,0.0,7.0\n"));
    CHECK(trace.brake_on_s() == Approx(0.2));
}
