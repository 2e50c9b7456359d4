#include "firmware/can/signal.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <new>
#include <random>
#include <string>
#include <type_traits>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/controller_view.hpp"
#include "firmware/can/frame_gate.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/can/roles.hpp"
#include "firmware/control/estimate.hpp"
#include "firmware/control/speed_estimator.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

using namespace antiskid;
using namespace antiskid::can;

namespace {

struct Field {
    unsigned start = 0;
    unsigned bits = 0;
    bool motorola = false;
    bool is_signed = false;
};

/// Bit numbers of the DBC, most significant bit first: Intel counts up through the bytes, Motorola walks down
/// each byte.
std::vector<unsigned> bit_numbers(const Field& field) {
    std::vector<unsigned> numbers;
    if (!field.motorola) {
        for (unsigned i = field.bits; i-- > 0;) numbers.push_back(field.start + i);
        return numbers;
    }
    unsigned number = field.start;
    for (unsigned i = 0; i < field.bits; ++i) {
        numbers.push_back(number);
        number = number % 8 == 0 ? number + 15 : number - 1;
    }
    return numbers;
}

std::int64_t slow_read(const Field& field, const Frame& frame) {
    std::uint64_t raw = 0;
    for (const unsigned number : bit_numbers(field)) raw = raw << 1U | ((frame.data[number / 8] >> (number % 8)) & 1U);
    if (field.is_signed && (raw >> (field.bits - 1)) != 0) raw |= ~std::uint64_t{0} << field.bits;
    return static_cast<std::int64_t>(raw);
}

}  // namespace

TEST_CASE("a field lies where the DBC says, in both byte orders, at every place and width", "[CAN-020]") {
    const can_test::TempDir dir;
    const std::string dbc = can_test::contents("config/foreign.dbc");
    const std::string old_message = dbc.substr(dbc.find("BO_ 544 HYD_PRESSURE"), dbc.find("BO_ 560") - dbc.find("BO_ 544 HYD_PRESSURE"));
    const std::string binding = can_test::replaced(can_test::contents("config/foreign_binding.toml"),
                                                   "protection = \"counter\"\ncounter = \"MsgCnt\"\nmax_delta = 3\n", "protection = \"none\"\n");
    std::mt19937 random(20);
    const auto draw = [&](unsigned max) { return std::uniform_int_distribution<unsigned>(0, max)(random); };
    unsigned fields = 0;
    while (fields < 400) {
        const unsigned length = 1 + draw(7);
        Field field{.start = draw(63), .bits = 1 + draw(31), .motorola = draw(1) == 1, .is_signed = draw(1) == 1};
        bool inside = true;
        for (const unsigned number : bit_numbers(field)) inside = inside && number < 8 * length;
        const std::string message = "BO_ 544 HYD_PRESSURE: " + std::to_string(length) + " BENCH\n SG_ BrakePress : " + std::to_string(field.start) +
                                    "|" + std::to_string(field.bits) + "@" + (field.motorola ? "0" : "1") + (field.is_signed ? "-" : "+") +
                                    " (0.5,0) [0|0] \"Pa\" ABCU\n\n";
        const auto dbc_path = dir.write("a.dbc", can_test::replaced(dbc, old_message, message));
        const auto binding_path = dir.write("a.toml", can_test::replaced(binding, "unit = \"bar\"", "unit = \"Pa\""));
        INFO(message);
        if (!inside) {
            CHECK_THROWS_WITH(load_layout(dbc_path, binding_path), ContainsSubstring("sticks out"));
            continue;
        }
        ++fields;
        const Layout layout = load_layout(dbc_path, binding_path);
        RigPort rig(layout, control::Time{1'000'000});
        ControllerPort port(layout, control::Time{1'000'000});
        for (int i = 0; i < 20; ++i) {
            const std::int64_t span = std::int64_t{1} << field.bits;
            std::int64_t raw = std::uniform_int_distribution<std::int64_t>(0, span - 1)(random);
            if (field.is_signed) raw -= span / 2;
            // Exact in single precision, so that what comes out must be what went in.
            if (field.bits > 24) raw -= raw % 512;
            const auto value = static_cast<float>(static_cast<double>(raw) * 0.5);
            const Frame frame = rig.pressure(value);
            REQUIRE(frame.length == length);
            const auto clamped = static_cast<double>(slow_read(field, frame)) * 0.5;
            CHECK(static_cast<float>(clamped) == value);
            port.accept(frame);
            CHECK(port.sensors().pressure.pressure_Pa == value);
        }
    }
}

TEST_CASE("values are rounded to the nearest step, halves away from zero, and limited to the range", "[CAN-020]") {
    const Signal s{
        .shift = 0, .bits = 8, .big_endian = false, .is_signed = true, .raw_min = -100, .raw_max = 50, .scale = 0.5, .per_scale = 2.0, .offset = 1.0};
    CHECK(s.raw(1.0) == 0);
    CHECK(s.raw(1.24) == 0);
    CHECK(s.raw(1.25) == 1);
    CHECK(s.raw(0.75) == -1);
    CHECK(s.raw(0.76) == 0);
    CHECK(s.raw(1e300) == 50);
    CHECK(s.raw(-1e300) == -100);
    CHECK(s.raw(std::numeric_limits<double>::infinity()) == 50);
    CHECK(s.raw(-std::numeric_limits<double>::infinity()) == -100);
    CHECK(s.raw(std::numeric_limits<double>::quiet_NaN()) == -2);  // that is the value 0
    CHECK(s.rounded(3.1) == 3.0);
}

TEST_CASE("a valve current that is no number goes out as no current", "[CAN-020]") {
    ControllerPort port(can_test::ours(), control::Time{1'000'000});
    RigPort rig(can_test::ours(), control::Time{1'000'000});
    rig.accept(port.valve_command(12.3456F));
    CHECK(rig.controller().current_mA == 12.346F);
    rig.accept(port.valve_command(std::numeric_limits<float>::quiet_NaN()));
    CHECK(rig.controller().current_mA == 0.0F);
    rig.accept(port.valve_command(-3.0F));
    CHECK(rig.controller().current_mA == 0.0F);
    rig.accept(port.valve_command(1e30F));
    CHECK(rig.controller().current_mA == 65.535F);
}

TEST_CASE("every raw value survives decoding and encoding again", "[CAN-020]") {
    for (const Layout* layout : {&can_test::ours(), &can_test::foreign()}) {
        for (const Signal& s : {layout->pressure_Pa, layout->valve_current_mA, layout->maneuver.demand_Pa, layout->maneuver.slip_reference,
                                layout->maneuver.deceleration_mps2, layout->maneuver.current_mA, layout->status.slip, layout->status.speed_mps}) {
            bool same = true;
            for (std::int64_t raw = s.raw_min; raw <= s.raw_max; ++raw) {
                same = same && s.raw(static_cast<double>(static_cast<float>(s.value(raw)))) == raw;
            }
            CHECK(same);
        }
    }
}

TEST_CASE("a signal that no layout has described is none, and passes a value as it is", "[CAN-020]") {
    const Signal none;
    CHECK_FALSE(none.bound());
    CHECK(none.shift == 0);
    CHECK(none.raw_min == 0);
    CHECK(none.raw_max == 0);
    CHECK(none.value(7) == 7.0);
    CHECK(none.per_scale == 1.0);
    Signal flag;
    flag.bits = 1;
    CHECK(flag.bound());
}

TEST_CASE("what the addressees said arrives with its time, each by itself", "[CAN-058]") {
    const Layout& layout = can_test::ours();
    ControllerPort port(layout, Time{1'000'000});
    control::Command command;
    command.faults = control::FaultSet::from_bits(0xFFFF'FFFFU);
    command.state = control::State::safe;
    ControllerView view;
    std::array<Frame, ControllerPort::kMaxFrames> frames{};
    std::int64_t at = 0;
    for (int step = 0; step < 200; ++step) {
        const std::size_t count = port.due_frames(command, frames);
        for (std::size_t i = 0; i < count; ++i) {
            const Time received{++at};
            for (const Role role : kToRig) {
                if (layout[role].id != frames[i].id) continue;
                REQUIRE(apply(layout, role, Payload(frames[i].data), received, view));
                const Time seen = role == Role::valve    ? view.command_received
                                  : role == Role::status ? view.status_received
                                  : role == Role::faults ? view.faults_received
                                  : role == Role::road   ? view.road_received
                                                         : view.heartbeat_received;
                REQUIRE(seen == received);
            }
        }
    }
    CHECK(at > 200);
    CHECK(view.faults.bits() == 0x03FF'FFFFU);
    CHECK(view.state == control::State::safe);
}

TEST_CASE("identifiers beyond eleven bits are nobody's", "[CAN-050]") {
    const Layout& layout = can_test::ours();
    for (const std::uint32_t id : {0x800U, 0x801U, 0x1FFF'FFFFU, 0xFFFF'FFFFU}) {
        FrameGate gate(layout, kToController);
        const Frame frame{.id = id, .length = layout[Role::wheel].length, .data = {}, .received = {}};
        CHECK_FALSE(gate.check(frame, Payload(frame.data)).role.has_value());
        CHECK(gate.unknown_ids() == 1);
    }
}

namespace {

/// Whether a value that nobody has filled in is zero in every byte.
template <typename T>
bool starts_at_zero() {
    static_assert(std::is_trivially_destructible_v<T>);
    alignas(T) std::array<std::byte, sizeof(T)> memory{};
    new (memory.data()) T;
    return std::ranges::all_of(memory, [](std::byte b) { return b == std::byte{}; });
}

}  // namespace

TEST_CASE("a sample that nobody has filled in moves nothing", "[CAN-058]") {
    CHECK(starts_at_zero<SpeedSample>());
    CHECK(starts_at_zero<ManeuverSample>());
    CHECK(starts_at_zero<LoadCellSample>());
    CHECK(starts_at_zero<ManeuverStateSample>());
    CHECK(starts_at_zero<RigSample>());
    CHECK(starts_at_zero<Frame>());
    CHECK(starts_at_zero<control::Estimate>());
    CHECK(starts_at_zero<control::SpeedReading>());
    const ControllerView view;
    CHECK(view.current_mA == 0.0F);
    CHECK(view.slip == 0.0F);
    CHECK(view.slip_reference == 0.0F);
    const control::ManeuverInput maneuver;
    CHECK(maneuver.demand_Pa == 0.0F);
    CHECK(maneuver.current_mA == 0.0F);
    CHECK(maneuver.deceleration_mps2 == 0.0F);
    CHECK(control::PressureInput{}.pressure_Pa == 0.0F);
    CHECK(control::Command{}.slip == 0.0F);
    CHECK(ControllerPort(can_test::ours(), Time{1'000'000}).sync_number() == 0);
}

TEST_CASE("what was refused is the sum of its reasons", "[CAN-050]") {
    const MessageStats stats{.accepted = 1, .wrong_crc = 20, .wrong_counter = 300, .wrong_length = 4000, .wrong_value = 50'000};
    CHECK(stats.rejected() == 54'320);
}
