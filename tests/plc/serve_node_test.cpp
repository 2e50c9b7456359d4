/// The served rig on the in-process bus, with a clock that only waiting moves.
#include "plant_sim/virtual_rig/serve_node.hpp"

#include <vector>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/load_layout.hpp"
#include "firmware/can/roles.hpp"
#include "plant_sim/virtual_rig/serve_reporter.hpp"
#include "tests/catch.hpp"
#include "tests/plc/operator.hpp"
#include "tests/plc/serve_stand.hpp"

using namespace serve_test;

TEST_CASE("the served rig sends its sensors and SYNC, and nothing that is the bridge's", "[RIG-270]") {
    Stand s;
    const bool lockstep = GENERATE(true, false);
    if (lockstep)
        s.node.run_lockstep(s.stop);
    else
        s.node.run_realtime(s.stop);
    const std::uint64_t periods = s.node.state().periods;
    CHECK(periods == Approx(1000.0).margin(2.0));
    for (const Role role : {Role::wheel, Role::flywheel, Role::pressure})
        CHECK(static_cast<double>(s.count(role)) == Approx(static_cast<double>(periods)).margin(1.0));
    CHECK(s.count(Role::sync) == (lockstep ? periods : 0));
    for (const Role role : {Role::maneuver, Role::rig_heartbeat, Role::load_cells, Role::emergency_stop}) CHECK(s.count(role) == 0);
    // Never faster than real time.
    CHECK(s.clock.now() >= (static_cast<std::int64_t>(periods) - 1) * kMillisecond);
}

TEST_CASE("the brake is handed out after each maneuver, to a reporter on another thread", "[RIG-300]") {
    plc::ServedRigOptions options = plc::load_served_rig("config", Bench::endurance);
    options.brake.emplace(plc_test::loaded(Bench::endurance).wear, wear::ConditionalRule{}, wear::BrakeState{.seed = 4});
    Stand s;
    plc::ServedRig rig(s.op.plant, options, 1);
    plant_sim::ServeNode node(rig, s.layout, s.bus, s.clock, kMillisecond, [&s](plc::ServedRig& r) { s.exchange(r); });
    s.end_s = 24.0;
    s.current_mA = 20.0;
    s.on_period = [&] {
        const auto at = [&](double time_s) { return std::abs(rig.time_s() - time_s) < 5e-4; };
        if (at(0.1) || at(12.1)) s.op.wish({.drive = true, .speed_mps = 2.0});
        if (at(4.0) || at(16.0)) s.op.wish({.advance = true, .load = true});
        if (at(9.0) || at(21.0)) s.op.wish({});
    };
    std::vector<wear::BrakeState> kept;
    antiskid::host::SupervisedCan idle(
        [&]() -> std::unique_ptr<antiskid::can::Bus> { return std::make_unique<WaitingBus>(s.hub.connect(), s.clock); });
    std::vector<std::string> said;
    {
        const plant_sim::ServeReporter reporter(
            node, idle, "can7", 1e-3, [&](const std::string& line) { said.push_back(line); },
            [&](const wear::BrakeState& state) {
                kept.push_back(state);
                return kept.size() == 2 ? std::string("second") : std::string();
            });
        node.run_lockstep(s.stop);
    }
    REQUIRE(kept.size() == 2);
    CHECK(kept[0].maneuvers == 1);
    CHECK(kept[0].c_e_J > 100.0);
    CHECK(kept[1].c_e_J > kept[0].c_e_J);
    CHECK(kept[1] == rig.brake()->state());
    CHECK(std::count_if(said.begin(), said.end(), [](const std::string& line) { return line.ends_with("s: second"); }) == 1);
}

TEST_CASE("the valve command of the period acts in it", "[RIG-270]") {
    Stand s;
    s.current_mA = 20.0;
    s.node.run_lockstep(s.stop);
    CHECK(s.node.state().controller_heard);
    const double full_Pa = s.op.plant.rig.pressure_map.pressure_Pa(20.0);
    CHECK(s.op.rig.rig().pressure_Pa() == Approx(full_Pa).epsilon(1e-6));
    // No wait: every answer was there, and rig time is real time.
    CHECK(s.clock.now() < kSecond + 200 * kMillisecond);
}

TEST_CASE("lockstep over the bus is the rig in process, bit for bit", "[RIG-270]") {
    Stand s;
    s.end_s = 3.0;
    s.current_mA = 12.5;
    s.op.wish({.drive = true, .speed_mps = 10.0});
    s.node.run_lockstep(s.stop);
    plc_test::Operator twin(Bench::endurance);
    twin.wish({.drive = true, .speed_mps = 10.0});
    // The first answer is taken for one that comes late, and acts in the same period all the same.
    while (twin.rig.time_s() < s.op.rig.time_s()) twin.tick(12.5);
    CHECK(twin.rig.time_s() == s.op.rig.time_s());
    CHECK(twin.rig.rig().wheel().distance_m == s.op.rig.rig().wheel().distance_m);
    CHECK(twin.rig.measured() == s.op.rig.measured());
    CHECK(twin.rig.sample().flywheel.edge_time == s.op.rig.sample().flywheel.edge_time);
    CHECK(twin.v() > 5.0);
}

TEST_CASE("a silent controller: the driver holds for 20 ms of rig time, then gives no current; the rig goes on", "[RIG-270]") {
    const bool lockstep = GENERATE(true, false);
    Stand s;
    s.current_mA = 20.0;
    s.end_s = 2.0;
    double silent_from_s = -1.0;
    double dropped_at_s = -1.0;
    std::int64_t answered_to = 0;
    if (!lockstep)
        s.clock.on_time = [&](Time now) {
            // Once a millisecond, as a controller by its own clock.
            if (s.answers && now / kMillisecond != answered_to) s.answer();
            answered_to = now / kMillisecond;
        };
    s.on_period = [&] {
        const double now_s = s.op.rig.time_s();
        if (silent_from_s < 0.0 && now_s >= 0.5) {
            s.answers = false;
            silent_from_s = now_s;
        }
        if (silent_from_s >= 0.0 && dropped_at_s < 0.0 && s.op.rig.rig().pressure_Pa() < 9e6) dropped_at_s = now_s;
    };
    const Time before = s.clock.now();
    if (lockstep)
        s.node.run_lockstep(s.stop);
    else
        s.node.run_realtime(s.stop);
    CHECK_FALSE(s.node.state().controller_heard);
    CHECK(s.op.rig.rig().pressure_Pa() < 1.0);
    // 20 ms of the driver and 6 ms of the valve's delay, then the pressure falls.
    CHECK(dropped_at_s - silent_from_s > 0.020);
    CHECK(dropped_at_s - silent_from_s < 0.035);
    // One answer was waited for, the others not.
    CHECK(s.clock.now() - before < 2 * kSecond + 300 * kMillisecond);
    CHECK(s.count(Role::wheel) >= 1999);
}

TEST_CASE("a controller that comes back is heard again, and has caught up when it counts", "[RIG-270]") {
    Stand s;
    s.current_mA = 20.0;
    s.end_s = 2.0;
    long unanswered = 0;
    s.on_period = [&] {
        const double now_s = s.op.rig.time_s();
        s.answers = now_s < 0.5 || now_s >= 1.0;
        if (now_s < 1.0) return;
        // The backlog of SYNCs is answered late, with old currents.
        if (unanswered == 0) {
            s.current_mA = 5.0;
            for (int i = 0; i < 100; ++i) s.answer();
            s.current_mA = 15.0;
            unanswered = 1;
        }
    };
    s.node.run_lockstep(s.stop);
    CHECK(s.node.state().controller_heard);
    CHECK(s.op.rig.rig().pressure_Pa() == Approx(s.op.plant.rig.pressure_map.pressure_Pa(15.0)).epsilon(1e-6));
}

TEST_CASE("the interface goes down and comes back: the rig goes on without current, and sends again", "[RIG-270]") {
    const bool lockstep = GENERATE(true, false);
    Stand s;
    s.current_mA = 20.0;
    s.end_s = 3.0;
    std::int64_t answered_to = 0;
    if (!lockstep)
        s.clock.on_time = [&](Time now) {
            if (now / kMillisecond != answered_to) s.answer();
            answered_to = now / kMillisecond;
        };
    bool was_down = false;
    bool safe = false;
    s.on_period = [&] {
        const double now_s = s.op.rig.time_s();
        const bool down = now_s >= 1.0 && now_s < 2.0;
        s.near.set_link(!down, false);
        if (now_s > 1.2 && now_s < 1.9) {
            was_down = was_down || !s.node.state().link_up;
            safe = safe || s.op.rig.rig().pressure_Pa() < 1.0;
        }
    };
    if (lockstep)
        s.node.run_lockstep(s.stop);
    else
        s.node.run_realtime(s.stop);
    CHECK(was_down);
    CHECK(safe);
    CHECK(s.node.state().link_up);
    CHECK(s.node.state().controller_heard);
    CHECK(s.node.state().frames_lost > 900);
    CHECK(s.op.rig.rig().pressure_Pa() > 5e6);
    CHECK(static_cast<double>(s.count(Role::wheel)) == Approx(2000.0).margin(20.0));
}

TEST_CASE("periods that the machine missed have passed for the plant", "[RIG-270]") {
    Stand s;
    s.end_s = 4.0;
    bool stalled = false;
    s.on_period = [&] {
        if (!stalled && s.op.rig.time_s() >= 1.0) {
            stalled = true;
            s.clock.pass(2 * kSecond);
        }
    };
    s.node.run_realtime(s.stop);
    CHECK(s.node.state().overruns == Approx(2000.0).margin(2.0));
    CHECK(s.node.state().periods == Approx(4000.0).margin(2.0));
    CHECK(s.count(Role::wheel) == Approx(2000.0).margin(4.0));
}

TEST_CASE("trips and refusals are there for who reports", "[RIG-270]") {
    Stand s;
    s.end_s = 1.0;
    s.op.wish({.drive = true, .speed_mps = 1000.0});
    s.on_period = [&] { s.op.rig.open_interlocks(s.op.rig.time_s() > 0.5 ? 1U << 1U : 0U); };
    s.node.run_lockstep(s.stop);
    CHECK(s.node.state().trip == plc::Trip::guard_open);
    CHECK(s.node.state().rejected == 256U + static_cast<unsigned>(plc::Rejection::range));
}

TEST_CASE("foreign traffic and broken commands move no valve", "[RIG-270]") {
    Stand s;
    s.answers = false;
    s.current_mA = 20.0;
    s.end_s = 0.5;
    s.on_period = [&] {
        Frame broken = s.controller.valve_command(20.0F);
        broken.data[0] ^= 0xFFU;
        (void)s.far.send(broken);
        Frame foreign = broken;
        foreign.id = 0x7AA;
        (void)s.far.send(foreign);
    };
    s.node.run_lockstep(s.stop);
    CHECK_FALSE(s.node.state().controller_heard);
    CHECK(s.op.rig.rig().pressure_Pa() == 0.0);
}
