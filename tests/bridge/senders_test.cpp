// One sender of an identifier or two, by frames made by hand.
#include "rig_bridge/bridge/senders.hpp"

#include <random>
#include <vector>

#include "firmware/can/e2e.hpp"
#include "tests/bridge/fakes.hpp"
#include "tests/catch.hpp"

using antiskid::can::Frame;
using antiskid::can::Message;
using antiskid::can::Payload;
using antiskid::can::Role;

namespace {

/// Frames of one message; `mark` is what its payload carries.
class HandMade {
  public:
    explicit HandMade(const Message& message, std::uint16_t counter = 0, std::uint8_t mark = 0) : message_(message), counter_(counter), mark_(mark) {}
    Frame next() {
        Frame frame{.id = message_.id, .length = message_.length};
        Payload payload;
        payload.write(message_.protection.counter, counter_);
        frame.data = payload.bytes();
        frame.data[2] = mark_;
        frame.data[message_.protection.crc_byte] = antiskid::can::e2e_crc(frame, message_.protection);
        counter_ = static_cast<std::uint16_t>((counter_ + 1U) % message_.protection.counter_modulo);
        return frame;
    }

  private:
    const Message& message_;
    std::uint16_t counter_;
    std::uint8_t mark_;
};

constexpr int kModulo = 15;
constexpr int kEnough = 14;  // frames of both

struct Listener {
    explicit Listener(Role role) : message(layout[role]), senders(message) {}
    void hear(const Frame& frame) { senders.accept(frame); }

    antiskid::can::Layout layout = bridge_test::layout();
    const Message& message;
    rig::bridge::Senders senders;
};

}  // namespace

TEST_CASE("Two senders are told by fourteen frames, whatever lies between their counters", "[BRG-460]") {
    for (const Role role : {Role::status, Role::valve, Role::maneuver}) {
        for (std::uint16_t apart = 0; apart < kModulo; ++apart) {
            CAPTURE(name(role), apart);
            Listener ear(role);
            HandMade first(ear.message), second(ear.message, apart, 1);
            for (int i = 0; i < kEnough; ++i) ear.hear(i % 2 == 0 ? first.next() : second.next());
            CHECK_THAT(ear.senders.text(), Catch::Matchers::StartsWith("two senders of 0x"));
        }
    }
}

TEST_CASE("Two that come in bursts, lose frames or begin late are two", "[BRG-460]") {
    Listener ear(Role::valve);
    HandMade first(ear.message), second(ear.message, 7, 1);
    SECTION("a host that runs them in turns") {
        for (int burst = 0; burst < 10; ++burst) {
            for (int i = 0; i < 6; ++i) ear.hear(first.next());
            for (int i = 0; i < 6; ++i) ear.hear(second.next());
        }
    }
    SECTION("the second begins after an hour") {
        for (int i = 0; i < 10000; ++i) ear.hear(first.next());
        for (int i = 0; i < kEnough; ++i) ear.hear(i % 2 == 0 ? second.next() : first.next());
    }
    SECTION("one frame in twenty is lost") {
        int named = 0;
        for (int i = 0; i < 2000; ++i) {
            const Frame one = first.next(), other = second.next();
            if (i % 20 != 3) ear.hear(one);
            if (i % 20 != 9) ear.hear(other);
            named += ear.senders.several() ? 1 : 0;
        }
        CHECK(named > 500);
    }
    SECTION("three of them") {
        HandMade third(ear.message, 11, 2);
        for (int i = 0; i < 6; ++i) {
            ear.hear(first.next());
            ear.hear(second.next());
            ear.hear(third.next());
        }
    }
    CHECK(ear.senders.several());
}

TEST_CASE("One sender stays one, whatever becomes of its frames", "[BRG-460]") {
    std::mt19937 random(640);
    const auto one_in = [&random](unsigned n) { return random() % n == 0; };
    for (const Role role : {Role::status, Role::valve}) {
        for (const unsigned often : {3U, 8U, 20U, 100U}) {
            CAPTURE(name(role), often);
            Listener ear(role);
            auto sender = std::make_unique<HandMade>(ear.message);
            std::vector<Frame> late;
            int named = 0;
            for (int i = 0; i < 100000; ++i) {
                if (one_in(40 * often)) sender = std::make_unique<HandMade>(ear.message);
                Frame frame = sender->next();
                if (one_in(often)) continue;  // lost
                if (one_in(2 * often)) {
                    late.push_back(frame);
                    continue;
                }
                if (one_in(2 * often)) frame.data[1] ^= 0x10U;
                ear.hear(frame);
                if (one_in(2 * often)) ear.hear(frame);
                if (!late.empty() && one_in(3)) {
                    ear.hear(late.front());
                    late.erase(late.begin());
                }
                named += ear.senders.several() ? 1 : 0;
            }
            CHECK(named == 0);
        }
    }
}

TEST_CASE("A few frames that are replayed are no sender, a stream of them is one", "[BRG-460]") {
    Listener ear(Role::valve);
    HandMade sender(ear.message);
    std::vector<Frame> recorded;
    for (int i = 0; i < 100; ++i) recorded.push_back(sender.next());
    for (const Frame& frame : recorded) ear.hear(frame);
    for (std::size_t i = 0; i < 4; ++i) {
        ear.hear(recorded[20 + i]);
        ear.hear(sender.next());
        CHECK_FALSE(ear.senders.several());
    }
    for (std::size_t i = 4; i < 12; ++i) {
        ear.hear(recorded[20 + i]);
        ear.hear(sender.next());
    }
    CHECK(ear.senders.several());
    for (int i = 0; i < kEnough; ++i) ear.hear(sender.next());
    CHECK_FALSE(ear.senders.several());  // over
}

TEST_CASE("Equal counters are said to be equal: somebody may repeat each frame of one sender", "[BRG-460]") {
    Listener ear(Role::status);
    HandMade sender(ear.message);
    for (int i = 0; i < kEnough; ++i) {
        const Frame frame = sender.next();
        ear.hear(frame);
        ear.hear(frame);
    }
    CHECK_THAT(ear.senders.text(), Catch::Matchers::StartsWith("every frame of 0x180 comes twice, at counter "));
}

TEST_CASE("Other identifiers, damaged frames and messages without a counter say nothing", "[BRG-460]") {
    Listener ear(Role::status);
    HandMade first(ear.message), second(ear.message, 7), valve(ear.layout[Role::valve]);
    for (int i = 0; i < 100; ++i) {
        ear.hear(first.next());
        Frame frame = second.next();
        frame.data[3] ^= 1U;
        ear.hear(frame);
        frame = second.next();
        frame.length = 3;
        ear.hear(frame);
        ear.hear(valve.next());
    }
    CHECK_FALSE(ear.senders.several());
    Message bare = ear.message;
    bare.protection = {};
    rig::bridge::Senders none(bare);
    Message two_bits = ear.message;
    two_bits.protection.counter_modulo = 4;
    rig::bridge::Senders little(two_bits);
    HandMade coarse(two_bits), other(two_bits, 2);
    for (int i = 0; i < 100; ++i) {
        for (rig::bridge::Senders* senders : {&none, &little}) {
            senders->accept(coarse.next());
            senders->accept(other.next());
        }
    }
    CHECK_FALSE(none.several());
    CHECK_FALSE(little.several());
}

TEST_CASE("A second controller is told by its valve commands or its status, a second bridge by its commands", "[BRG-460]") {
    const antiskid::can::Layout layout = bridge_test::layout();
    for (const Role role : {Role::valve, Role::status, Role::maneuver}) {
        rig::bridge::DuplicateSenders duplicates(layout);
        CHECK((duplicates.two_controllers().empty() && duplicates.two_bridges().empty()));
        HandMade first(layout[role]), second(layout[role], 4, 1);
        for (int i = 0; i < kEnough; ++i) duplicates.accept(i % 2 == 0 ? first.next() : second.next());
        CHECK(duplicates.two_controllers().empty() == (role == Role::maneuver));
        CHECK(duplicates.two_bridges().empty() == (role != Role::maneuver));
    }
}
