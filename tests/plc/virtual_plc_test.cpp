/// The PLC's program by itself: what it takes over, what it refuses, what trips it, what resets it.
#include "plant_sim/plc/virtual_plc.hpp"

#include <array>
#include <limits>

#include "tests/catch.hpp"

using plc::Rejection;
using plc::Trip;
using rig::Commanded;
using rig::Interlock;
using rig::PlcState;

namespace {

constexpr unsigned kGood = 0b1111;

struct Panel {
    plc::VirtualPlc plc{{.speed_max_mps = 70.0, .force_max_N = 40e3, .lift_max_Ns2pm2 = 10.0, .watchdog_s = 0.5}};
    rig::CommandedValues c{};
    unsigned good = kGood;
    double rim_mps = 0.0;
    double now_s = 0.0;
    bool alive = true;

    double& operator[](Commanded q) { return rig::at(c, q); }
    void scan(int scans = 1) {
        for (int i = 0; i < scans; ++i) {
            now_s += 0.01;
            if (alive) rig::at(c, Commanded::bridge_watchdog) += 1.0;
            plc.scan(c, good, rim_mps, now_s);
        }
    }
    /// Whether the commit was taken over.
    bool commit() {
        auto& number = rig::at(c, Commanded::commit);
        number += 1.0;
        scan();
        const bool applied = plc.applied_commit() == number;
        const bool rejected = plc.rejected_commit() == number;
        REQUIRE(applied != rejected);
        return applied;
    }
    void enable_drive() {
        (*this)[Commanded::drive_enable] = 1.0;
        (*this)[Commanded::flywheel_speed_mps] = 50.0;
        REQUIRE(commit());
    }
    void all_off() {
        for (const auto q : {Commanded::drive_enable, Commanded::sledge_advance, Commanded::load_enable, Commanded::reset}) rig::at(c, q) = 0.0;
    }
};

}  // namespace

TEST_CASE("commands act with the commit, all at once, and only then", "[RIG-210]") {
    Panel p;
    p[Commanded::drive_enable] = 1.0;
    p[Commanded::flywheel_speed_mps] = 50.0;
    p.scan(3);
    CHECK_FALSE(p.plc.commands().drive);
    CHECK(p.plc.applied_commit() == 0);
    CHECK(p.commit());
    CHECK(p.plc.commands().drive);
    CHECK(p.plc.commands().speed_mps == 50.0);
    p[Commanded::flywheel_speed_mps] = 30.0;
    p.scan(3);
    CHECK(p.plc.commands().speed_mps == 50.0);
    CHECK(p.commit());
    CHECK(p.plc.commands().speed_mps == 30.0);
    // The same number again is no commit, and neither is 0.
    p[Commanded::flywheel_speed_mps] = 20.0;
    p.scan();
    p[Commanded::commit] = 0.0;
    p.scan();
    CHECK(p.plc.commands().speed_mps == 30.0);
    // Any other number is, wherever it comes from.
    p[Commanded::commit] = 65535.0;
    p.scan();
    CHECK(p.plc.applied_commit() == 65535);
    CHECK(p.plc.commands().speed_mps == 20.0);
}

TEST_CASE("a refused commit changes nothing and says so", "[RIG-210]") {
    Panel p;
    p.enable_drive();
    struct Case {
        Commanded quantity;
        double value;
        Rejection rejection;
    };
    const auto bad = GENERATE(Case{Commanded::drive_enable, 2.0, Rejection::value}, Case{Commanded::sledge_advance, 0.5, Rejection::value},
                              Case{Commanded::load_enable, -1.0, Rejection::value}, Case{Commanded::reset, 7.0, Rejection::value},
                              Case{Commanded::flywheel_speed_mps, std::numeric_limits<double>::quiet_NaN(), Rejection::value},
                              Case{Commanded::load_base_N, std::numeric_limits<double>::infinity(), Rejection::value},
                              Case{Commanded::flywheel_speed_mps, 70.1, Rejection::range},
                              Case{Commanded::flywheel_speed_mps, -0.1, Rejection::range}, Case{Commanded::load_base_N, 40.1e3, Rejection::range},
                              Case{Commanded::load_base_N, -1.0, Rejection::range}, Case{Commanded::load_lift_Ns2pm2, 10.1, Rejection::range});
    p[Commanded::flywheel_speed_mps] = 40.0;
    p[bad.quantity] = bad.value;
    CHECK_FALSE(p.commit());
    CHECK(p.plc.rejection() == bad.rejection);
    CHECK(p.plc.commands().drive);
    CHECK(p.plc.commands().speed_mps == 50.0);
    CHECK(p.plc.state() == PlcState::ready);
    CHECK(p.plc.applied_commit() == 1);
}

TEST_CASE("both ends of every range are taken over", "[RIG-210]") {
    Panel p;
    p[Commanded::flywheel_speed_mps] = 70.0;
    p[Commanded::load_base_N] = 40e3;
    p[Commanded::load_lift_Ns2pm2] = 10.0;
    CHECK(p.commit());
    p[Commanded::flywheel_speed_mps] = 0.0;
    p[Commanded::load_base_N] = 0.0;
    p[Commanded::load_lift_Ns2pm2] = 0.0;
    CHECK(p.commit());
}

TEST_CASE("what does not go together is refused", "[RIG-210]") {
    Panel p;
    p[Commanded::load_base_N] = 20e3;
    SECTION("load without the sledge at the rim") {
        p[Commanded::load_enable] = 1.0;
        CHECK_FALSE(p.commit());
        CHECK(p.plc.rejection() == Rejection::load_off_rim);
    }
    SECTION("the drive against the loaded wheel") {
        p[Commanded::load_enable] = p[Commanded::sledge_advance] = p[Commanded::drive_enable] = 1.0;
        CHECK_FALSE(p.commit());
        CHECK(p.plc.rejection() == Rejection::drive_against_load);
    }
    SECTION("eq. (2) below zero at the rim's present speed") {
        p[Commanded::load_enable] = p[Commanded::sledge_advance] = 1.0;
        p[Commanded::load_lift_Ns2pm2] = 8.0;
        p.rim_mps = 50.1;
        CHECK_FALSE(p.commit());
        CHECK(p.plc.rejection() == Rejection::load_law);
        p.rim_mps = 50.0;
        CHECK(p.commit());
    }
    SECTION("a turning flywheel may be touched, with the drive on") {
        p[Commanded::drive_enable] = p[Commanded::sledge_advance] = 1.0;
        p[Commanded::flywheel_speed_mps] = 50.0;
        p.rim_mps = 50.0;
        CHECK(p.commit());
    }
}

TEST_CASE("nothing is enabled for a bridge whose watchdog does not move", "[RIG-214]") {
    Panel p;
    p.alive = false;
    const auto what = GENERATE(Commanded::drive_enable, Commanded::sledge_advance);
    p[what] = 1.0;
    CHECK_FALSE(p.commit());
    CHECK(p.plc.rejection() == Rejection::unsupervised);
    p.all_off();
    CHECK(p.commit());
    p.alive = true;
    p[what] = 1.0;
    CHECK(p.commit());
}

TEST_CASE("each interlock trips: everything off, at once, until reset", "[RIG-214]") {
    struct Case {
        Interlock interlock;
        Trip trip;
    };
    const auto opened = GENERATE(Case{Interlock::emergency_stop_clear, Trip::emergency_stop}, Case{Interlock::guard_closed, Trip::guard_open},
                                 Case{Interlock::hydraulics_ready, Trip::hydraulics_lost}, Case{Interlock::drive_healthy, Trip::drive_fault});
    Panel p;
    p.enable_drive();
    p[Commanded::sledge_advance] = 1.0;
    REQUIRE(p.commit());
    p.good = kGood & ~(1U << static_cast<unsigned>(opened.interlock));
    p.scan();
    CHECK(p.plc.state() == PlcState::tripped);
    CHECK(p.plc.trip() == opened.trip);
    CHECK_FALSE(p.plc.commands().drive);
    CHECK_FALSE(p.plc.commands().advance);
    CHECK_FALSE(p.plc.commands().load);
    // Good again is not ready again.
    p.good = kGood;
    p.scan(10);
    CHECK(p.plc.state() == PlcState::tripped);
    CHECK_FALSE(p.commit());
    CHECK(p.plc.rejection() == Rejection::tripped);
    CHECK_FALSE(p.plc.commands().drive);
}

TEST_CASE("the bridge's watchdog trips after its time, not before, and not before it has moved once", "[RIG-214]") {
    Panel p;
    p.alive = false;
    p.scan(1000);
    CHECK(p.plc.state() == PlcState::ready);
    p.alive = true;
    p.enable_drive();
    p.alive = false;
    p.scan(49);
    CHECK(p.plc.state() == PlcState::ready);
    CHECK(p.plc.commands().drive);
    p.scan(2);
    CHECK(p.plc.state() == PlcState::tripped);
    CHECK(p.plc.trip() == Trip::bridge_silent);
    CHECK_FALSE(p.plc.commands().drive);
}

TEST_CASE("a watchdog that moves slowly, or wraps, keeps the PLC ready", "[RIG-214]") {
    Panel p;
    p[Commanded::bridge_watchdog] = 65533.0;
    p.enable_drive();
    p.alive = false;
    for (const double value : {65535.0, 0.0, 1.0, 2.0}) {
        p[Commanded::bridge_watchdog] = value;
        p.scan(48);
    }
    CHECK(p.plc.state() == PlcState::ready);
}

TEST_CASE("reset: on its rising edge, with good interlocks, and it starts nothing", "[RIG-214]") {
    Panel p;
    p.enable_drive();
    p.good = 0b1101;
    p.scan();
    REQUIRE(p.plc.state() == PlcState::tripped);
    p.all_off();
    SECTION("refused while an interlock is open") {
        p[Commanded::reset] = 1.0;
        CHECK_FALSE(p.commit());
        CHECK(p.plc.rejection() == Rejection::interlock);
        CHECK(p.plc.state() == PlcState::tripped);
        p.good = kGood;
        p.scan(5);
        CHECK(p.plc.state() == PlcState::tripped);  // the refused one does not act later
        CHECK(p.commit());
        CHECK(p.plc.state() == PlcState::ready);
    }
    SECTION("refused together with anything that moves") {
        p.good = kGood;
        const auto what = GENERATE(Commanded::drive_enable, Commanded::sledge_advance);
        p[Commanded::reset] = p[what] = 1.0;
        CHECK_FALSE(p.commit());
        CHECK(p.plc.rejection() == Rejection::tripped);
        CHECK(p.plc.state() == PlcState::tripped);
    }
    SECTION("refused for a silent bridge") {
        p.good = kGood;
        p.alive = false;
        p.scan(60);
        p[Commanded::reset] = 1.0;
        CHECK_FALSE(p.commit());
        CHECK(p.plc.rejection() == Rejection::unsupervised);
    }
    SECTION("a reset that is held does not clear the next trip") {
        p.good = kGood;
        p[Commanded::reset] = 1.0;
        CHECK(p.commit());
        REQUIRE(p.plc.state() == PlcState::ready);
        CHECK_FALSE(p.plc.commands().drive);
        p.good = 0b0111;
        p.scan();
        p.good = kGood;
        REQUIRE(p.plc.state() == PlcState::tripped);
        CHECK(p.commit());
        CHECK(p.plc.state() == PlcState::tripped);
        p[Commanded::reset] = 0.0;
        CHECK(p.commit());
        CHECK(p.plc.state() == PlcState::tripped);
        p[Commanded::reset] = 1.0;
        CHECK(p.commit());
        CHECK(p.plc.state() == PlcState::ready);
    }
}

TEST_CASE("the PLC's own watchdog counts every scan, modulo 65536", "[RIG-210]") {
    Panel p;
    p.scan(3);
    CHECK(p.plc.watchdog() == 3);
    p.scan(65536);
    CHECK(p.plc.watchdog() == 3);
}

TEST_CASE("any garbage in the registers leaves the PLC in one of its states, with orders in range", "[RIG-210]") {
    Panel p;
    std::uint64_t x = 88172645463325252ULL;
    const std::array<double, 8> values{0.0, 1.0, -1.0, 1e9, 0.5, 65536.0, 50.0, std::numeric_limits<double>::quiet_NaN()};
    for (int i = 0; i < 200000; ++i) {
        x ^= x << 13U;
        x ^= x >> 7U;
        x ^= x << 17U;
        p.c[x % rig::kCommandedCount] = values[(x >> 8U) % values.size()];
        p.good = (x >> 16U) % 8 == 0 ? static_cast<unsigned>(x >> 20U) & kGood : kGood;
        p.alive = (x >> 32U) % 2 == 0;
        p.scan();
        const plc::MachineCommands& o = p.plc.commands();
        REQUIRE((o.speed_mps >= 0.0 && o.speed_mps <= 70.0));
        REQUIRE((o.load_base_N >= 0.0 && o.load_base_N <= 40e3));
        REQUIRE_FALSE((o.load && (o.drive || !o.advance)));
        if (p.plc.state() == PlcState::tripped) REQUIRE_FALSE((o.drive || o.advance || o.load));
        if (p.good != kGood) REQUIRE(p.plc.state() == PlcState::tripped);
    }
}
