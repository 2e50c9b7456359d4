#include <array>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/observer.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/can/value_names.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

using namespace antiskid;
using namespace antiskid::can;
using can_test::foreign;
using can_test::ours;
using control::Time;

namespace {

constexpr Time kPeriod{1'000'000};

RigSample sample_at(int step) {
    RigSample sample;
    const auto n = static_cast<std::uint32_t>(step);
    sample.wheel = {.edge_count = 2 * n, .edge_time = Time{n * 999'983LL}, .speed_radps = 150.0F};
    sample.flywheel = {.edge_count = 3 * n, .edge_time = Time{n * 999'979LL}, .speed_radps = 160.0F};
    sample.pressure_Pa = 1e4F * static_cast<float>(step % 700);
    sample.maneuver.demand_Pa = 2e7F;
    sample.maneuver.arm = step > 100;
    sample.load_cells = {
        .vertical_N = 23'532.0F, .longitudinal_N = 2100.0F, .brake_torque_Nm = static_cast<float>(step % 900), .age = Time{step % 40 * 1'000'000}};
    sample.maneuver_state = {.phase = static_cast<std::uint8_t>(step / 150 % 11),
                             .number = n / 1650,
                             .brake_temperature_C = 20.0F + 0.1F * static_cast<float>(step % 3000)};
    return sample;
}

std::vector<Frame> due(RigPort& port, const RigSample& sample) {
    std::array<Frame, RigPort::kMaxFrames> frames;
    const std::size_t count = port.due_frames(sample, frames);
    return {frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(count)};
}

}  // namespace

TEST_CASE("sensors and bridge together send what one rig sends, and the maneuver state", "[CAN-100]") {
    RigPort whole(ours(), kPeriod);
    RigPort sensors(ours(), kPeriod, kFromRigSensors);
    RigPort bridge(ours(), kPeriod, kFromBridge);
    for (int step = 0; step < 2000; ++step) {
        RigSample sample = sample_at(step);
        sample.emergency_stop = step % 97 == 0;
        std::multiset<std::string> expected;
        std::multiset<std::string> got;
        const auto bytes = [](const Frame& frame) {
            std::string all = std::to_string(frame.id) + '#';
            for (const std::uint8_t byte : frame.payload()) all += static_cast<char>(byte);
            return all;
        };
        for (const Frame& frame : due(whole, sample)) expected.insert(bytes(frame));
        for (RigPort* port : {&sensors, &bridge}) {
            for (const Frame& frame : due(*port, sample)) {
                if (frame.id != ours()[Role::maneuver_state].id) got.insert(bytes(frame));
            }
        }
        REQUIRE(got == expected);
    }
}

TEST_CASE("the maneuver state is sent every 100 ms and once at every change", "[CAN-100]") {
    for (const int step_ms : {1, 10}) {
        RigPort bridge(ours(), step_ms * kPeriod, kFromBridge);
        RigSample sample;
        int sent = 0;
        const auto steps = [&](int count) {
            sent = 0;
            for (int i = 0; i < count; ++i) {
                for (const Frame& frame : due(bridge, sample)) {
                    if (frame.id == ours()[Role::maneuver_state].id) ++sent;
                }
            }
            return sent;
        };
        CHECK(steps(1) == 1);
        CHECK(steps(1000 / step_ms) == 10);
        sample.maneuver_state.phase = 4;
        CHECK(steps(1) == 1);
        sample.maneuver_state.number = 7;
        CHECK(steps(1) == 1);
        sample.maneuver_state.brake_temperature_C = 300.0F;  // comes with the period
        CHECK(steps(1) == 0);
    }
    RigPort elsewhere(foreign(), kPeriod, kFromBridge);
    std::size_t frames = 0;
    for (int step = 0; step < 20; ++step) frames += due(elsewhere, {}).size();
    CHECK(frames == 2);  // a layout without telemetry: maneuver command and heartbeat
}

TEST_CASE("a phase that does not exist is refused", "[CAN-100]") {
    RigPort bridge(ours(), kPeriod, kFromBridge);
    Observer observer(ours());
    for (std::uint8_t phase = 0; phase < 16; ++phase) {
        const auto role = observer.accept(bridge.maneuver_state({.phase = phase, .number = 1, .brake_temperature_C = 0.0F}));
        CHECK(role.has_value() == (phase < kPhaseNames.size()));
    }
    CHECK(observer.stats(Role::maneuver_state).wrong_value == 5);
    CHECK(observer.view().maneuver_state.phase == 10);
}

TEST_CASE("telemetry on the bus changes nothing that the controller knows", "[CAN-100]") {
    RigPort rig(ours(), kPeriod);
    RigPort sensors(ours(), kPeriod, kFromRigSensors);
    RigPort bridge(ours(), kPeriod, kFromBridge);
    ControllerPort without(ours(), kPeriod);
    ControllerPort with(ours(), kPeriod);
    std::uint32_t telemetry = 0;
    const auto feed = [](ControllerPort& port, Frame frame, Time now) {
        frame.received = now;
        port.accept(frame);
    };
    for (int step = 0; step < 2000; ++step) {
        const Time now = (step + 1) * kPeriod;
        for (const Frame& frame : due(rig, sample_at(step))) {
            if (frame.id != ours()[Role::load_cells].id) feed(without, frame, now);
        }
        for (RigPort* port : {&bridge, &sensors}) {
            for (const Frame& frame : due(*port, sample_at(step))) {
                feed(with, frame, now);
                if (frame.id == ours()[Role::load_cells].id || frame.id == ours()[Role::maneuver_state].id) ++telemetry;
            }
        }
        const control::Sensors& a = without.sensors();
        const control::Sensors& b = with.sensors();
        const bool same = a.wheel.received == b.wheel.received && a.wheel.rejected == b.wheel.rejected && a.wheel.edge_count == b.wheel.edge_count &&
                          a.wheel.edge_time == b.wheel.edge_time && a.flywheel.received == b.flywheel.received &&
                          a.flywheel.rejected == b.flywheel.rejected && a.flywheel.edge_count == b.flywheel.edge_count &&
                          a.flywheel.edge_time == b.flywheel.edge_time && a.pressure.received == b.pressure.received &&
                          a.pressure.rejected == b.pressure.rejected && a.pressure.pressure_Pa == b.pressure.pressure_Pa &&
                          a.maneuver.received == b.maneuver.received && a.maneuver.rejected == b.maneuver.rejected &&
                          a.maneuver.arm == b.maneuver.arm && a.maneuver.demand_Pa == b.maneuver.demand_Pa &&
                          a.rig_heartbeat_received == b.rig_heartbeat_received && a.emergency_stop == b.emergency_stop;
        REQUIRE(same);
    }
    CHECK(with.unknown_ids() == telemetry);
    CHECK(telemetry > 200);
}

TEST_CASE("the observer reads what the addressees read, in either direction", "[CAN-100]") {
    for (const Layout* layout : {&ours(), &foreign()}) {
        RigPort rig(*layout, kPeriod);
        RigPort bridge(*layout, kPeriod, kFromBridge);
        ControllerPort port(*layout, kPeriod);
        Observer observer(*layout);
        control::Command command;
        for (int step = 0; step < 3000; ++step) {
            const Time now = (step + 1) * kPeriod;
            const RigSample sample = sample_at(step);
            for (Frame frame : due(rig, sample)) {
                frame.received = now;
                port.accept(frame);
                CHECK(observer.accept(frame).has_value());
            }
            if ((*layout)[Role::maneuver_state].bound) {
                Frame frame = bridge.maneuver_state(sample.maneuver_state);
                frame.received = now;
                CHECK(observer.accept(frame) == Role::maneuver_state);
                CHECK(observer.view().maneuver_state.number == sample.maneuver_state.number);
                CHECK(observer.view().maneuver_state.brake_temperature_C == Approx(sample.maneuver_state.brake_temperature_C).margin(0.051));
            }
            Frame sync = rig.sync(static_cast<std::uint32_t>(step));
            sync.received = now;
            CHECK(observer.accept(sync) == Role::sync);
            command.current_mA = 0.01F * static_cast<float>(step);
            command.state = static_cast<control::State>(step % control::kStateCount);
            command.slip = 0.2F;
            std::array<Frame, ControllerPort::kMaxFrames> frames;
            const std::size_t count = port.due_frames(command, frames);
            for (std::size_t i = 0; i < count; ++i) {
                frames[i].received = now;
                rig.accept(frames[i]);
                CHECK(observer.accept(frames[i]).has_value());
            }
            const BusView& view = observer.view();
            const control::Sensors& sensors = port.sensors();
            const bool same =
                view.wheel.edge_count == sensors.wheel.edge_count && view.wheel.edge_time == sensors.wheel.edge_time &&
                view.wheel.received == sensors.wheel.received && view.wheel.speed_radps == sensors.wheel.speed_radps &&
                view.flywheel.edge_count == sensors.flywheel.edge_count && view.flywheel.edge_time == sensors.flywheel.edge_time &&
                view.flywheel.speed_radps == sensors.flywheel.speed_radps && view.pressure.pressure_Pa == sensors.pressure.pressure_Pa &&
                view.pressure.received == sensors.pressure.received && view.maneuver.demand_Pa == sensors.maneuver.demand_Pa &&
                view.maneuver.arm == sensors.maneuver.arm && view.rig_heartbeat_received == sensors.rig_heartbeat_received &&
                view.sync_received == now && view.sync_number == (static_cast<std::uint32_t>(step) & layout->sync_counter.mask()) &&
                view.controller.current_mA == rig.controller().current_mA && view.controller.state == rig.controller().state &&
                view.controller.slip == rig.controller().slip && view.controller.command_received == rig.controller().command_received &&
                view.controller.heartbeat_received == rig.controller().heartbeat_received;
            REQUIRE(same);
        }
        CHECK(observer.unknown_ids() == 0);
    }
}

TEST_CASE("the observer sees stops, and a SYNC that carries nothing", "[CAN-100][CAN-201]") {
    Layout silent = ours();
    silent.sync_counter = {};
    RigPort rig(silent, kPeriod);
    Observer observer(silent);
    ControllerPort port(silent, kPeriod);
    Frame stop = rig.emergency_stop();
    stop.received = Time{5};
    CHECK(observer.view().emergency_stop_received == control::kNever);
    CHECK(observer.accept(stop) == Role::emergency_stop);
    CHECK(observer.view().emergency_stop_received == Time{5});
    Frame sync = rig.sync(7);
    CHECK(sync.data == std::array<std::uint8_t, 8>{});
    sync.received = Time{6};
    CHECK(observer.accept(sync) == Role::sync);
    CHECK(observer.view().sync_received == Time{6});
    CHECK(observer.view().sync_number == 0);
    port.accept(sync);
    CHECK(port.sync_count() == 1);
    CHECK(port.sync_number() == 0);
}

TEST_CASE("a controller's message is taken over, or refused whole; other roles are none of its", "[CAN-050][CAN-201]") {
    ControllerView view;
    const auto taken = [&view](Role role, const std::array<std::uint8_t, 8>& bytes) { return apply(ours(), role, Payload(bytes), Time{9}, view); };
    for (unsigned state = 0; state < 16; ++state) {
        const bool exists = state < control::kStateCount;
        CHECK(taken(Role::status, {0, static_cast<std::uint8_t>(state << 4U), 0, 0, 0, 0, 0, 0}) == exists);
    }
    CHECK(view.state == control::State::safe);
    view = {};
    for (const Role role : kToController) CHECK_FALSE(taken(role, {1, 2, 3, 4, 5, 6, 7, 8}));
    CHECK(view.command_received == control::kNever);
    CHECK(view.status_received == control::kNever);
}

TEST_CASE("the observer refuses what the addressees refuse", "[CAN-100]") {
    RigPort rig(ours(), kPeriod);
    ControllerPort port(ours(), kPeriod);
    Observer observer(ours());
    std::mt19937 random(110);
    for (int step = 0; step < 5000; ++step) {
        for (Frame frame : due(rig, sample_at(step))) {
            const auto chance = random() % 10;
            if (chance == 0) frame.data[random() % frame.length] ^= static_cast<std::uint8_t>(1U << (random() % 8));
            if (chance == 1) --frame.length;
            if (chance == 2) continue;
            if (chance == 3) frame.id = random() % 2048;
            port.accept(frame);
            observer.accept(frame);
            if (chance == 4) {
                port.accept(frame);
                observer.accept(frame);
            }
        }
    }
    for (const Role role : {Role::wheel, Role::flywheel, Role::pressure, Role::maneuver, Role::rig_heartbeat}) {
        const MessageStats& theirs = port.stats(role);
        const MessageStats& seen = observer.stats(role);
        CHECK(seen.accepted == theirs.accepted);
        CHECK(seen.rejected() == theirs.rejected());
        CHECK(seen.lost == theirs.lost);
        CHECK(seen.rejected() > 0);
    }
}

TEST_CASE("the observer has the rig's telemetry with its time", "[CAN-100]") {
    RigPort rig(ours(), kPeriod, kFromBridge);
    Observer observer(ours());
    int cells = 0, states = 0;
    for (int step = 0; step < 400; ++step) {
        const RigSample sample = sample_at(step);
        for (Frame frame : due(rig, sample)) {
            frame.received = Time{step + 1};
            const auto role = observer.accept(frame);
            if (role == Role::load_cells) {
                ++cells;
                REQUIRE(observer.view().load_cells_received == frame.received);
                REQUIRE(observer.view().load_cells.vertical_N == Approx(23'532.0).margin(10.0));
                REQUIRE(observer.view().load_cells.longitudinal_N == Approx(2100.0).margin(10.0));
                REQUIRE(observer.view().load_cells.brake_torque_Nm == Approx(step % 900).margin(2.0));
                REQUIRE(std::abs((observer.view().load_cells.age - Time{std::min(step % 40, 30) * 1'000'000}).count()) <= 1'000'000);
            }
            if (role == Role::maneuver_state) {
                ++states;
                REQUIRE(observer.view().maneuver_state_received == frame.received);
                REQUIRE(observer.view().maneuver_state.phase == step / 150);
            }
        }
    }
    CHECK(cells > 10);
    CHECK(states > 3);
    const std::uint32_t before = observer.unknown_ids();
    CHECK_FALSE(observer.accept({.id = 0x7FF, .length = 0, .data = {}, .received = {}}).has_value());
    CHECK(observer.unknown_ids() == before + 1);
}
