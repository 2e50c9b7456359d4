#include "firmware/can/e2e.hpp"

#include <string>
#include <vector>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/crc8.hpp"
#include "firmware/can/rig_port.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

using namespace antiskid;
using namespace antiskid::can;
using can_test::foreign;
using can_test::ours;

namespace {

std::vector<std::uint8_t> bytes(const std::string& hex) {
    std::vector<std::uint8_t> out;
    for (std::size_t i = 0; i < hex.size(); i += 2) {
        out.push_back(static_cast<std::uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
    }
    return out;
}

/// Bit by bit, straight from the definition.
std::uint8_t slow_crc(const std::vector<std::uint8_t>& data) {
    unsigned crc = 0xFF;
    for (const std::uint8_t byte : data) {
        crc ^= byte;
        for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x80U) != 0 ? ((crc << 1U) ^ 0x1DU) & 0xFFU : crc << 1U;
    }
    return static_cast<std::uint8_t>(crc ^ 0xFFU);
}

E2e profile(std::uint8_t max_delta) {
    E2e e2e;
    e2e.protection = Protection::counter_crc;
    e2e.counter = {.shift = 8, .bits = 4};
    e2e.crc_byte = 0;
    e2e.data_id = 0x1234;
    e2e.max_delta = max_delta;
    return e2e;
}

/// A frame of `config` with the given counter and a right CRC.
Frame frame_with(const E2e& config, unsigned counter) {
    Frame frame{.id = 1, .length = 8, .data = {0, 0, 3, 4, 5, 6, 7, 8}, .received = {}};
    Payload payload(frame.data);
    payload.write(config.counter, counter);
    frame.data = payload.bytes();
    if (config.protection == Protection::counter_crc) frame.data[config.crc_byte] = e2e_crc(frame, config);
    return frame;
}

E2eResult check(E2eChecker& checker, const E2e& config, const Frame& frame, std::uint32_t& lost) {
    return checker.check(config, frame, Payload(frame.data), lost);
}

/// Every message that the controller receives with a CRC.
std::vector<Frame> protected_frames(const Layout& layout, const RigSample& sample) {
    RigPort rig(layout, control::Time{1'000'000});
    std::vector<Frame> frames;
    const auto add = [&](Role role, const Frame& frame) {
        if (layout[role].protection.protection == Protection::counter_crc) frames.push_back(frame);
    };
    add(Role::wheel, rig.wheel(sample.wheel));
    add(Role::flywheel, rig.flywheel(sample.flywheel));
    add(Role::pressure, rig.pressure(sample.pressure_Pa));
    add(Role::maneuver, rig.maneuver(sample.maneuver));
    add(Role::rig_heartbeat, rig.heartbeat());
    add(Role::emergency_stop, rig.emergency_stop());
    return frames;
}

bool accepts(const Layout& layout, const Frame& frame) {
    ControllerPort port(layout, control::Time{1'000'000});
    port.accept(frame);
    std::uint32_t accepted = 0;
    for (std::size_t i = 0; i < kRoleCount; ++i) accepted += port.stats(static_cast<Role>(i)).accepted;
    return accepted != 0;
}

RigSample protected_sample() {
    RigSample sample;
    sample.wheel = {.edge_count = 0xA5C3, .edge_time = control::Time{123'456'789'000}, .speed_radps = 150.0F};
    sample.flywheel = {.edge_count = 77, .edge_time = control::Time{42}, .speed_radps = 160.0F};
    sample.pressure_Pa = 5.5e6F;
    sample.maneuver = {.law = control::Law::threshold,
                       .arm = true,
                       .weight_on_wheels = true,
                       .demand_Pa = 2.07e7F,
                       .slip_reference = 0.24F,
                       .deceleration_mps2 = 3.24F,
                       .current_mA = 17.0F};
    return sample;
}

}  // namespace

TEST_CASE("CRC-8/SAE-J1850 gives the published check values", "[CAN-010]") {
    const std::string text = "123456789";
    CHECK(crc8(std::vector<std::uint8_t>(text.begin(), text.end())) == 0x4B);
    CHECK(crc8(bytes("00000000")) == 0x59);
    CHECK(crc8(bytes("F20183")) == 0x37);
    CHECK(crc8(bytes("0FAA0055")) == 0x79);
    CHECK(crc8(bytes("00FF5511")) == 0xB8);
    CHECK(crc8(bytes("332255AABBCCDDEEFF")) == 0xCB);
    CHECK(crc8(bytes("926B55")) == 0x8C);
    CHECK(crc8(bytes("FFFFFFFF")) == 0x74);
}

TEST_CASE("the CRC covers the data ID, low byte first, and the payload without its own byte", "[CAN-010]") {
    Frame frame{.id = 1, .length = 5, .data = {0x11, 0x22, 0xEE, 0x44, 0x55, 0x99, 0x99, 0x99}, .received = {}};
    E2e config = profile(1);
    config.crc_byte = 2;
    CHECK(e2e_crc(frame, config) == slow_crc({0x34, 0x12, 0x11, 0x22, 0x44, 0x55}));
}

TEST_CASE("every flip of one or two bits of every protected frame is refused", "[CAN-010]") {
    for (const Layout* layout : {&ours(), &foreign()}) {
        for (const RigSample& sample : {RigSample{}, protected_sample()}) {
            for (const Frame& frame : protected_frames(*layout, sample)) {
                REQUIRE(accepts(*layout, frame));
                const std::size_t bits = std::size_t{frame.length} * 8;
                const auto flip = [](Frame& f, std::size_t bit) { f.data[bit / 8] = static_cast<std::uint8_t>(f.data[bit / 8] ^ (1U << (bit % 8))); };
                std::size_t wrongly_accepted = 0;
                for (std::size_t a = 0; a < bits; ++a) {
                    Frame one = frame;
                    flip(one, a);
                    wrongly_accepted += accepts(*layout, one) ? 1 : 0;
                    for (std::size_t b = a + 1; b < bits; ++b) {
                        Frame two = one;
                        flip(two, b);
                        wrongly_accepted += accepts(*layout, two) ? 1 : 0;
                    }
                }
                INFO("identifier " << frame.id);
                CHECK(wrongly_accepted == 0);
            }
        }
    }
}

TEST_CASE("a right frame under the identifier of another message is refused", "[CAN-010]") {
    RigPort rig(ours(), control::Time{1'000'000});
    Frame frame = rig.wheel(protected_sample().wheel);
    frame.id = ours()[Role::flywheel].id;
    CHECK_FALSE(accepts(ours(), frame));
}

TEST_CASE("the sender counts 0 to 14 and starts over", "[CAN-010]") {
    const E2e config = profile(1);
    E2eSender sender;
    for (unsigned i = 0; i < 40; ++i) {
        Frame frame{.id = 1, .length = 8, .data = {}, .received = {}};
        sender.protect(config, {}, frame);
        CHECK(Payload(frame.data).read(config.counter) == static_cast<std::int64_t>(i % 15));
        CHECK(frame.data[0] == e2e_crc(frame, config));
    }
}

TEST_CASE("the checker accepts steps of 1 to max_delta, from every counter value", "[CAN-010]") {
    for (unsigned max_delta = 1; max_delta <= 7; ++max_delta) {
        const E2e config = profile(static_cast<std::uint8_t>(max_delta));
        for (unsigned first = 0; first < 15; ++first) {
            for (unsigned second = 0; second < 16; ++second) {
                E2eChecker checker;
                std::uint32_t lost = 0;
                REQUIRE(check(checker, config, frame_with(config, first), lost) == E2eResult::ok);
                const E2eResult verdict = check(checker, config, frame_with(config, second), lost);
                const unsigned delta = (second + 15 - first) % 15;
                INFO("max_delta " << max_delta << ": " << first << " then " << second);
                if (second == 15) {
                    CHECK(verdict == E2eResult::wrong_sequence);
                } else if (delta == 0) {
                    CHECK(verdict == E2eResult::repeated);
                } else if (delta <= max_delta) {
                    CHECK(verdict == E2eResult::ok);
                    CHECK(lost == delta - 1);
                } else {
                    CHECK(verdict == E2eResult::wrong_sequence);
                    CHECK(lost == 0);
                }
            }
        }
    }
}

TEST_CASE("a step that is too large costs one frame, then the sequence goes on from there", "[CAN-010]") {
    const E2e config = profile(2);
    E2eChecker checker;
    std::uint32_t lost = 0;
    CHECK(check(checker, config, frame_with(config, 3), lost) == E2eResult::ok);
    CHECK(check(checker, config, frame_with(config, 9), lost) == E2eResult::wrong_sequence);
    CHECK(check(checker, config, frame_with(config, 10), lost) == E2eResult::ok);
    CHECK(check(checker, config, frame_with(config, 9), lost) == E2eResult::wrong_sequence);
    CHECK(check(checker, config, frame_with(config, 11), lost) == E2eResult::ok);
}

TEST_CASE("repeats and frames with a wrong CRC leave the sequence as it was", "[CAN-010]") {
    const E2e config = profile(1);
    E2eChecker checker;
    std::uint32_t lost = 0;
    CHECK(check(checker, config, frame_with(config, 3), lost) == E2eResult::ok);
    for (int i = 0; i < 5; ++i) {
        CHECK(check(checker, config, frame_with(config, 3), lost) == E2eResult::repeated);
        Frame wrong = frame_with(config, 9);
        wrong.data[5] ^= 1U;
        CHECK(check(checker, config, wrong, lost) == E2eResult::wrong_crc);
        CHECK(check(checker, config, frame_with(config, 15), lost) == E2eResult::wrong_sequence);
    }
    CHECK(check(checker, config, frame_with(config, 4), lost) == E2eResult::ok);
}

TEST_CASE("an emergency stop counts however its counter stands, but never with a wrong CRC", "[CAN-010]") {
    RigPort rig(ours(), control::Time{1'000'000});
    ControllerPort port(ours(), control::Time{1'000'000});
    const Frame first = rig.emergency_stop();
    Frame wrong = first;
    wrong.data[1] ^= 0x10U;
    port.accept(wrong);
    CHECK_FALSE(port.sensors().emergency_stop);
    for (int i = 0; i < 3; ++i) {
        port.accept(first);
        CHECK(port.sensors().emergency_stop);
        port.clear_one_shots();
        CHECK_FALSE(port.sensors().emergency_stop);
    }
}

TEST_CASE("protection by counter alone uses the whole field", "[CAN-010]") {
    const E2e& config = foreign()[Role::pressure].protection;
    REQUIRE(config.protection == Protection::counter);
    CHECK(config.counter_modulo == 16);
    RigPort rig(foreign(), control::Time{1'000'000});
    ControllerPort port(foreign(), control::Time{1'000'000});
    for (int i = 0; i < 40; ++i) port.accept(rig.pressure(1e6F));
    CHECK(port.stats(Role::pressure).accepted == 40);
    CHECK(port.stats(Role::pressure).lost == 0);
    static_cast<void>(rig.pressure(1e6F));
    port.accept(rig.pressure(1e6F));
    CHECK(port.stats(Role::pressure).lost == 1);
    for (int i = 0; i < 3; ++i) static_cast<void>(rig.pressure(1e6F));
    port.accept(rig.pressure(1e6F));
    CHECK(port.stats(Role::pressure).wrong_counter == 1);
}
