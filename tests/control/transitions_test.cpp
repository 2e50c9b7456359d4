// The state machine's diagram as a table: each transition in it is made, and no other.
#include <array>
#include <random>

#include "tests/control/stand.hpp"

using namespace antiskid::control;
using control_test::kPeriod_s;
using control_test::kRadius_m;
using control_test::Stand;

namespace {

constexpr auto idx(const State s) {
    return static_cast<std::size_t>(s);
}

/// What may follow what, besides staying: the diagram of supervisor.hpp as a table. Rows and columns in the order of State.
constexpr std::array<std::array<bool, kStateCount>, kStateCount> kMayFollow{{
    //             self_test standby armed touchdown braking locked drop_out safe
    /* self_test */ {false, true, false, false, false, false, false, true},
    /* standby   */ {false, false, true, false, false, false, false, true},
    /* armed     */ {false, true, false, true, true, true, true, true},
    /* touchdown */ {false, true, true, false, true, true, true, true},
    /* braking   */ {false, true, true, false, false, true, true, true},
    /* locked    */ {false, true, true, false, true, false, true, true},
    /* drop_out  */ {false, true, true, false, true, true, false, true},
    /* safe      */ {false, true, false, false, false, false, false, false},
}};

}  // namespace

TEST_CASE("random inputs make every transition of the table and no other", "[CTL-076]") {
    std::array<std::array<int, kStateCount>, kStateCount> seen{};
    std::mt19937 random(5);
    const auto chance = [&random](const double p) { return std::uniform_real_distribution<>(0.0, 1.0)(random) < p; };
    const auto between = [&random](const float a, const float b) { return std::uniform_real_distribution<float>(a, b)(random); };
    for (int run = 0; run < 400; ++run) {
        Stand s;
        State before = State::self_test;
        bool edge = false, disarmed = true;
        float on_wheels_s = 0.0F;
        bool spun_up = false;
        for (int k = 0; k < 6000; ++k) {
            const bool calm = run % 4 == 1;  // long enough on the wheels for the time-out
            const bool armed_before = s.sensors.maneuver.arm;
            if (chance(before == State::safe || before == State::standby ? 0.02 : calm ? 0.0001 : 0.002)) s.sensors.maneuver.arm = !armed_before;
            if (chance(calm ? 0.0002 : 0.003)) s.sensors.maneuver.weight_on_wheels = !s.sensors.maneuver.weight_on_wheels;
            if (chance(0.01)) s.sensors.maneuver.demand_Pa = chance(0.3) ? 0.0F : between(0.0F, 20e6F);
            if (chance(0.005)) s.sensors.maneuver.law = static_cast<Law>(random() % kLawCount);
            if (chance(0.02)) {
                const float v = chance(0.3) ? between(0.0F, 8.0F) : between(0.0F, calm ? 27.0F : 70.0F);
                s.move(v, chance(0.3) ? 0.0F : v * between(0.0F, calm ? 0.68F : 1.1F));
            }
            if (chance(0.01)) s.sensors.pressure.pressure_Pa = chance(0.8) ? 0.0F : 1e6F;
            if (before == State::self_test && run % 3 == 0) {
                s.move(0.0F, 0.0F);
                s.sensors.pressure.pressure_Pa = run % 2 == 0 ? 1e6F : 0.0F;
            }
            s.present = {};
            if (chance(before == State::self_test ? 0.0 : calm ? 0.0001 : 0.0007)) s.present.insert(static_cast<Fault>(random() % kFaultCount));
            const bool faulty = !s.present.empty();

            const State after = s.step();
            // What the states need, said independently of the code.
            const ManeuverInput& m = s.sensors.maneuver;
            edge = m.arm && disarmed;
            disarmed = !m.arm;
            on_wheels_s = m.weight_on_wheels ? on_wheels_s + kPeriod_s : 0.0F;
            const float rim = s.estimate.omega_radps * kRadius_m;
            const bool along = s.estimate.v_mps > 5.0F && rim > 0.7F * s.estimate.v_mps;
            spun_up = m.weight_on_wheels && (spun_up || rim > 30.0F || along);
            const auto wrong = [&](const char* const what) {
                FAIL(what << ": run " << run << ", step " << k << ", " << idx(before) << " to " << idx(after));
            };
            if (after != before) ++seen[idx(before)][idx(after)];
            if (after != before && !kMayFollow[idx(before)][idx(after)]) {
                wrong("a transition that is not in the table");
            }
            if (faulty && before != State::self_test && after != State::safe) wrong("a fault without reaction");
            const bool active = after != State::self_test && after != State::standby && after != State::safe;
            if (active && !m.arm) wrong("active without arm");
            if (before == State::standby && after == State::armed && !edge) wrong("armed without an edge");
            const bool brakes = after == State::braking || after == State::drop_out;
            if (brakes) {
                if (!m.weight_on_wheels) wrong("braking in the air");
                if (!spun_up && on_wheels_s < 2.998F) wrong("braking within touchdown protection");
                if (m.demand_Pa < 0.2e6F) wrong("braking without a demand");
            }
            if (after == State::touchdown_protection && (spun_up || !m.weight_on_wheels)) wrong("protection without need");
            if (after == State::safe && s.supervisor.latched().empty()) wrong("safe without a name");
            if (after == State::braking && m.law != Law::open_loop && s.estimate.v_mps >= 6.0F &&
                s.estimate.omega_radps * kRadius_m < 0.299F * s.estimate.v_mps)
                wrong("braking a locked wheel");
            before = after;
        }
    }
    for (std::size_t from = 0; from < kStateCount; ++from) {
        for (std::size_t to = 0; to < kStateCount; ++to) {
            CAPTURE(from, to);
            CHECK((seen[from][to] > 0) == kMayFollow[from][to]);
        }
    }
}
