// How long a condition has to hold, to the period.
#include "firmware/control/persistence.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "firmware/control/arithmetic.hpp"
#include "tests/catch.hpp"
#include "tests/control/watch.hpp"

using namespace antiskid::control;
using control_test::kExact_s;

TEST_CASE("a condition that must not be broken is counted anew after every break", "[CTL-081]") {
    const float limit = GENERATE(1.0F, 8.0F, 8.4F, 8.6F);  // periods, to the nearest whole one
    Persistence persistence(limit * kExact_s, kExact_s);
    std::mt19937 random(3);
    int held = 0, wrong = 0;
    for (int k = 0; k < 20'000; ++k) {
        const bool bad = random() % 8U != 0U;
        held = bad ? held + 1 : 0;
        wrong += persistence.holds(bad) == (held >= std::lround(limit)) ? 0 : 1;
    }
    CHECK(wrong == 0);
}

TEST_CASE("a condition that comes and goes is paid back by half, and never owes more than its limit", "[CTL-081]") {
    const int limit = GENERATE(1, 2, 8, 20);  // periods
    FaultCounter counter(static_cast<float>(limit) * kExact_s, kExact_s);
    const auto holds = [&counter](const bool bad) {
        FaultSet wrong;
        if (bad) wrong.insert(Fault::bus_off);
        counter.take(wrong);
        REQUIRE((counter.found().empty() || counter.found() == wrong));
        return !counter.found().empty();
    };
    std::mt19937 random(4);
    double owed = 0.0;
    int wrong = 0, named = 0;
    for (int k = 0; k < 50'000; ++k) {
        // By turns mostly good, mostly bad and in between.
        const bool bad = random() % 8U < static_cast<unsigned>(k / 200) % 9U;
        if (!bad) owed = std::max(owed - 0.5, 0.0);
        if (bad && owed < limit) owed += 1.0;
        const bool expected = bad && owed >= limit;
        named += expected ? 1 : 0;
        wrong += holds(bad) == expected ? 0 : 1;
    }
    CHECK(wrong == 0);
    CHECK(named > 1000);
}

TEST_CASE("nothing is owed before the first bad period, and half a period counts as one", "[CTL-081]") {
    FaultCounter counter(4.0F * kExact_s, kExact_s);
    FaultSet one, other;
    one.insert(Fault::bus_off);
    other.insert(Fault::overrun);
    for (const FaultSet& wrong : {one, other, one, FaultSet{}}) {
        counter.take(wrong);
        CHECK(counter.found().empty());
    }
    counter.take(one);
    CHECK(counter.found().empty());  // three and a half
    counter.take(other);
    CHECK(counter.found() == other);  // by the name of the newest
    CHECK(counter.found() == other);
    CHECK(whole_periods(1.25F, 0.5F) == 3);
    CHECK(magnitude(0.5F) == 0.5F);
    CHECK(magnitude(-0.5F) == 0.5F);
}
