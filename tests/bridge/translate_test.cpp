#include "rig_bridge/bridge/translate.hpp"

#include <cmath>

#include "rig_bridge/bridge/view_model.hpp"
#include "tests/bridge/fakes.hpp"
#include "tests/catch.hpp"

using namespace bridge_test;
using antiskid::control::State;
using rig::Interlock;
using rig::Measured;

namespace {

const rig::bridge::Freshness kLimits;

rig::Inputs sequencer_inputs(const rig::modbus::Snapshot& plc, const rig::bridge::BusNow& bus, Time now = 1s) {
    return rig::bridge::sequencer_inputs(plc, bus, now, kLimits);
}

}  // namespace

TEST_CASE("A good rig is seen as it is", "[BRG-400]") {
    rig::modbus::Snapshot plc = good_plc();
    rig::at(plc.values, Measured::flywheel_speed_mps) = 61.0;
    rig::at(plc.values, Measured::sledge_position_m) = 0.25;
    rig::at(plc.values, Measured::wheel_on_rim) = 1.0;
    rig::at(plc.values, Measured::vertical_load_N) = 40e3;
    rig::bridge::BusNow bus = good_bus(1s);
    bus.rim_mps = 60.0;
    bus.wheel_radps = 140.0;
    bus.wheel_rim_mps = 45.0;
    bus.slip = 0.25;
    bus.view.pressure.pressure_Pa = 5e6F;
    const rig::Inputs in = sequencer_inputs(plc, bus);
    CHECK(in.plc_fresh);
    CHECK(in.plc_ready);
    CHECK((in.emergency_stop_clear && in.guard_closed && in.hydraulics_ready && in.drive_healthy));
    CHECK(in.flywheel_mps == 61.0);
    CHECK(in.flywheel_age_s == 0.01);
    CHECK(in.sledge_m == 0.25);
    CHECK(in.wheel_on_rim);
    CHECK(in.load_N == 40e3);
    CHECK(in.brake_temperature_C == 20.0);
    CHECK((in.bus_up && in.bus_read && in.sensors_fresh && in.controller_fresh && in.controller_standby));
    CHECK_FALSE((in.controller_armed || in.controller_safe || in.commit_rejected || in.commit_late || in.abort_requested));
    CHECK(in.rim_mps == 60.0);
    CHECK(in.wheel_radps == 140.0);
    CHECK(in.wheel_rim_mps == 45.0);
    CHECK(in.pressure_Pa == 5e6);
}

TEST_CASE("Each register that is old, implausible or no number makes the PLC silent", "[BRG-400]") {
    for (std::size_t i = 0; i < rig::kMeasuredCount; ++i) {
        CAPTURE(i);
        rig::modbus::Snapshot old = good_plc();
        old.age_s[i] = kLimits.registers_s + 0.01;
        CHECK_FALSE(sequencer_inputs(old, good_bus(1s)).plc_fresh);
        for (const auto quality : {rig::ValueQuality::never, rig::ValueQuality::implausible, rig::ValueQuality::not_a_number}) {
            rig::modbus::Snapshot bad = good_plc();
            bad.quality[i] = quality;
            CHECK_FALSE(sequencer_inputs(bad, good_bus(1s)).plc_fresh);
        }
    }
    rig::modbus::Snapshot stands = good_plc();
    stands.plc_watchdog_age_s = kLimits.watchdog_s + 0.01;
    CHECK_FALSE(sequencer_inputs(stands, good_bus(1s)).plc_fresh);
    stands.plc_watchdog_age_s = NAN;
    CHECK_FALSE(sequencer_inputs(stands, good_bus(1s)).plc_fresh);
    rig::modbus::Snapshot other_map = good_plc();
    other_map.link = rig::modbus::LinkState::map_rejected;
    CHECK_FALSE(sequencer_inputs(other_map, good_bus(1s)).plc_fresh);
}

TEST_CASE("Interlocks are each their own; a silent PLC has none", "[BRG-400]") {
    for (unsigned i = 0; i < rig::kInterlockCount; ++i) {
        rig::modbus::Snapshot plc = good_plc();
        rig::at(plc.values, Measured::interlocks) = 15.0 - static_cast<double>(1U << i);
        const rig::Inputs in = sequencer_inputs(plc, good_bus(1s));
        CHECK(in.emergency_stop_clear == (i != static_cast<unsigned>(Interlock::emergency_stop_clear)));
        CHECK(in.guard_closed == (i != static_cast<unsigned>(Interlock::guard_closed)));
        CHECK(in.hydraulics_ready == (i != static_cast<unsigned>(Interlock::hydraulics_ready)));
        CHECK(in.drive_healthy == (i != static_cast<unsigned>(Interlock::drive_healthy)));
        CHECK_FALSE(rig::bridge::interlocks_good(plc, kLimits));
        plc.age_s.fill(10.0);
        CHECK_FALSE(sequencer_inputs(plc, good_bus(1s)).emergency_stop_clear);
    }
    CHECK(rig::bridge::interlocks_good(good_plc(), kLimits));
}

TEST_CASE("A command that is refused, unsendable or not confirmed is known", "[BRG-400]") {
    rig::modbus::Snapshot plc = good_plc();
    plc.command = rig::modbus::CommandState::rejected;
    CHECK(sequencer_inputs(plc, good_bus(1s)).commit_rejected);
    plc.command = rig::modbus::CommandState::unsendable;
    CHECK(sequencer_inputs(plc, good_bus(1s)).commit_rejected);
    plc.command = rig::modbus::CommandState::pending;
    plc.pending_s = kLimits.commit_s - 0.01;
    CHECK_FALSE(sequencer_inputs(plc, good_bus(1s)).commit_late);
    plc.pending_s = kLimits.commit_s + 0.01;
    CHECK(sequencer_inputs(plc, good_bus(1s)).commit_late);
}

TEST_CASE("Silence on the bus counts from when the recorder last looked", "[BRG-400]") {
    const auto aged = [](Time received, Time valid_at) {
        rig::bridge::BusNow bus = good_bus(valid_at);
        bus.view.pressure.received = received;
        return bus;
    };
    CHECK(sequencer_inputs(good_plc(), aged(1s, 1s + 299ms), 1s + 299ms).sensors_fresh);
    CHECK_FALSE(sequencer_inputs(good_plc(), aged(1s, 1s + 301ms), 1s + 301ms).sensors_fresh);
    // The recorder was held up, not the sensors.
    CHECK(sequencer_inputs(good_plc(), aged(1s, 1s + 10ms), 1s + 500ms).sensors_fresh);
    // But not for ever.
    const rig::Inputs late = sequencer_inputs(good_plc(), aged(1s, 1s), 1s + 501ms);
    CHECK(late.bus_up);
    CHECK_FALSE((late.bus_read || late.sensors_fresh || late.controller_fresh));

    rig::bridge::BusNow quiet = good_bus(1s + 40ms);
    quiet.view.flywheel.received = 1s;
    CHECK(sequencer_inputs(good_plc(), quiet, 1s + 90ms).rim_age_s == Approx(0.04));

    rig::bridge::BusNow unheard = good_bus(1s);
    unheard.view.wheel.received = antiskid::control::kNever;
    CHECK_FALSE(sequencer_inputs(good_plc(), unheard).sensors_fresh);
    unheard = good_bus(1s);
    unheard.view.flywheel.received = antiskid::control::kNever;
    CHECK_FALSE(sequencer_inputs(good_plc(), unheard).sensors_fresh);
    rig::bridge::BusNow never = good_bus(1s);
    never.view.controller.status_received = antiskid::control::kNever;
    CHECK_FALSE(sequencer_inputs(good_plc(), never).controller_fresh);
    never.valid_at = antiskid::control::kNever;
    CHECK_FALSE(sequencer_inputs(good_plc(), never).bus_read);
    rig::bridge::BusNow down = good_bus(1s);
    down.up = false;
    CHECK_FALSE(sequencer_inputs(good_plc(), down).bus_up);
}

TEST_CASE("Every state of the controller is standby, safe, armed or none of them", "[BRG-400]") {
    for (std::uint8_t i = 0; i < antiskid::control::kStateCount; ++i) {
        const auto state = static_cast<State>(i);
        rig::bridge::BusNow bus = good_bus(1s);
        bus.view.controller.state = state;
        const rig::Inputs in = sequencer_inputs(good_plc(), bus);
        CHECK(in.controller_standby == (state == State::standby));
        CHECK(in.controller_safe == (state == State::safe));
        CHECK(in.controller_armed == (state != State::standby && state != State::safe && state != State::self_test));
    }
}

TEST_CASE("What the sequencer wants is what PLC and controller are told", "[BRG-400]") {
    rig::Outputs out;
    out.phase = rig::Phase::braking;
    out.drive_enable = true;
    out.flywheel_set_mps = 61.3;
    out.sledge_advance = true;
    out.load_enable = true;
    out.load_base_N = 43654.0;
    out.load_lift_Ns2pm2 = 2.5;
    out.arm = true;
    out.weight_on_wheels = true;
    out.law = rig::BrakeLaw::threshold;
    out.demand_Pa = 20e6;
    out.slip_reference = 0.24;
    out.deceleration_mps2 = 3.2;
    out.current_mA = 12.5;
    out.emergency_stop = true;
    const rig::CommandedValues c = rig::bridge::commands(out, false);
    CHECK(rig::at(c, rig::Commanded::drive_enable) == 1.0);
    CHECK(rig::at(c, rig::Commanded::flywheel_speed_mps) == 61.3);
    CHECK(rig::at(c, rig::Commanded::sledge_advance) == 1.0);
    CHECK(rig::at(c, rig::Commanded::load_enable) == 1.0);
    CHECK(rig::at(c, rig::Commanded::load_base_N) == 43654.0);
    CHECK(rig::at(c, rig::Commanded::load_lift_Ns2pm2) == 2.5);
    CHECK(rig::at(c, rig::Commanded::reset) == 0.0);
    CHECK(rig::at(rig::bridge::commands(out, true), rig::Commanded::reset) == 1.0);
    CHECK(rig::bridge::commands({}, false) == rig::CommandedValues{});

    const antiskid::can::RigSample s = rig::bridge::rig_sample(out, good_plc().values, 17);
    CHECK(s.maneuver.law == antiskid::control::Law::threshold);
    CHECK((s.maneuver.arm && s.maneuver.weight_on_wheels && s.emergency_stop));
    CHECK(s.maneuver.demand_Pa == 20e6F);
    CHECK(s.maneuver.slip_reference == 0.24F);
    CHECK(s.maneuver.deceleration_mps2 == 3.2F);
    CHECK(s.maneuver.current_mA == 12.5F);
    CHECK(s.maneuver_state.phase == 4);
    CHECK(s.maneuver_state.number == 17);
    CHECK(s.maneuver_state.brake_temperature_C == 20.0F);
    rig::modbus::Snapshot unread = good_plc();
    rig::at(unread.values, Measured::brake_temperature_C) = NAN;
    CHECK(rig::bridge::rig_sample(out, unread.values, 1).maneuver_state.brake_temperature_C == 0.0F);
}

TEST_CASE("Two senders of what one may send are told to the sequencer and to people", "[BRG-460]") {
    rig::bridge::Moment moment;
    moment.plc.link = rig::modbus::LinkState::connected;
    moment.bus = good_bus(1s);
    CHECK_FALSE(sequencer_inputs(good_plc(), moment.bus).two_senders);
    SECTION("controllers") {
        moment.bus.two_controllers = std::string("two senders of 0x100, at counters 3 and 9");
        CHECK(sequencer_inputs(good_plc(), moment.bus).two_senders);
        CHECK(note_of(moment) == "two controllers talk on the bus: two senders of 0x100, at counters 3 and 9");
        moment.bus.controller_rejected = std::string("counter");
        CHECK(note_of(moment) ==
              "two controllers talk on the bus: two senders of 0x100, at counters 3 and 9; heard but "
              "refused: counter");
    }
    SECTION("bridges") {
        moment.bus.two_bridges = std::string("two senders of 0x120, at counters 3 and 9");
        CHECK(sequencer_inputs(good_plc(), moment.bus).two_senders);
        CHECK(note_of(moment) == "two bridges command on the bus: two senders of 0x120, at counters 3 and 9");
    }
    SECTION("one controller, whose frames are all refused, is heard") {
        moment.bus.controller_rejected = std::string("CRC");
        CHECK_FALSE(sequencer_inputs(good_plc(), moment.bus).two_senders);
        CHECK(note_of(moment) == "the controller is heard but refused: CRC");
        CHECK(view_of(moment, kLimits).controller == "rejected");
    }
}
