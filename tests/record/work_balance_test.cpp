// Whose word counts when: load cells' or speeds'.
#include "rig_bridge/record/work_balance.hpp"

#include <cmath>

#include "tests/catch.hpp"

using rig::record::CellReading;
using rig::record::WorkBalance;

namespace {

/// By the cells the brake takes 100 W, by the speeds 200 W. New readings each 10 ms but from `from_s` to `to_s`, where the old one is said for
/// `again_s` more.
WorkBalance balance_after(double until_s, double from_s, double to_s, double again_s) {
    WorkBalance balance(0.0);
    double knot_s = 0.0;
    for (int n = 1; n <= static_cast<int>(std::lround(until_s * 1000.0)); ++n) {
        const double t = 1e-3 * n;
        CellReading reading = n % 10 == 0 ? CellReading::fresh : CellReading::none;
        if (t > from_s && t < to_s && reading == CellReading::fresh) reading = t < from_s + again_s ? CellReading::repeated : CellReading::none;
        if (balance.add(t, reading, {.brake_J = 100.0 * (t - knot_s)}, {.brake_J = 0.2})) knot_s = t;
    }
    return balance;
}

}  // namespace

TEST_CASE("readings that come late or are said again now and then are believed", "[BRG-200]") {
    for (const double hole_s : {0.0, 0.03, 0.09}) {
        const WorkBalance sound = balance_after(3.0, 1.0, 1.0 + hole_s, 0.05);
        CHECK(sound.work().brake_J == Approx(300.0));
        CHECK(sound.by_speeds().brake_J == 0.0);
        CHECK(sound.silent_s() == 0.0);
    }
    CHECK(balance_after(3.0, 1.0, 2.0, 1.0).by_speeds().brake_J == 0.0);  // a constant torque is no silence
}

TEST_CASE("a silence is the speeds' from the newest reading on that was new, to where readings are back", "[BRG-200]") {
    for (const double again_s : {0.0, 0.05, 0.1}) {
        CAPTURE(again_s);
        const WorkBalance ended = balance_after(3.0, 1.0, 2.0, again_s);
        CHECK(ended.work().brake_J == Approx(100.0 + 200.0 * 1.03 + 100.0 * 0.97).margin(1.0));
        CHECK(ended.by_speeds().brake_J == Approx(200.0 * 1.03).margin(1.0));
        CHECK(ended.silent_s() == Approx(1.03).margin(0.01));
        CHECK_FALSE(ended.silent());
        const WorkBalance lasting = balance_after(1.5, 1.0, 2.0, again_s);
        CHECK(lasting.silent());
        CHECK(lasting.work().brake_J == Approx(100.0 + 200.0 * 0.5).margin(1.0));
        CHECK(lasting.by_speeds().brake_J == Approx(200.0 * 0.5).margin(1.0));
    }
}

TEST_CASE("work since the time of a late reading is the present one's, and becomes the next one's", "[BRG-200]") {
    WorkBalance balance(0.0);
    const rig::record::WorkAhead ahead{.by_cells = {.brake_J = 5.0}, .by_speeds = {.brake_J = 7.0}};
    balance.add(0.01, CellReading::fresh, {.brake_J = 1.0}, {.brake_J = 2.0}, ahead);
    CHECK(balance.work().brake_J == 6.0);
    balance.add(0.02, CellReading::fresh, {.brake_J = 10.0}, {.brake_J = 20.0}, ahead);
    CHECK(balance.work().brake_J == 16.0);
    CHECK(balance.by_speeds().brake_J == 0.0);
    balance.add(0.2, CellReading::none, {.brake_J = 100.0}, {.brake_J = 200.0}, ahead);
    CHECK(balance.work().brake_J == 218.0);
    CHECK(balance.by_speeds().brake_J == 207.0);
    balance.add(0.21, CellReading::fresh, {.brake_J = 110.0}, {.brake_J = 20.0}, ahead);
    balance.add(0.25, CellReading::fresh, {.brake_J = 150.0}, {.brake_J = 80.0}, ahead);
    CHECK_FALSE(balance.silent());
    CHECK(balance.by_speeds().brake_J == 300.0);
    balance.add(0.26, CellReading::fresh, {.brake_J = 10.0}, {.brake_J = 20.0}, ahead);
    CHECK(balance.work().brake_J == 11.0 + 300.0 + 10.0 + 5.0);
}

TEST_CASE("a step over a hole of everything is the speeds' even where it ends with a reading", "[BRG-200]") {
    WorkBalance balance(0.0);
    balance.add(0.01, CellReading::fresh, {.brake_J = 1.0}, {.brake_J = 2.0});
    balance.add(1.01, CellReading::fresh, {.brake_J = 100.0}, {.brake_J = 200.0});
    CHECK(balance.silent());
    CHECK(balance.work().brake_J == 201.0);
    balance.add(1.05, CellReading::fresh, {.brake_J = 4.0}, {.brake_J = 8.0});
    CHECK_FALSE(balance.silent());
    CHECK(balance.work().brake_J == 209.0);
    balance.add(1.06, CellReading::fresh, {.brake_J = 1.0}, {.brake_J = 2.0});
    CHECK(balance.work().brake_J == 210.0);
    CHECK(balance.by_speeds().brake_J == 208.0);
}
