// Heard but refused: why, and whether two senders say the same identifier.
#include "rig_bridge/bridge/refused_frames.hpp"

#include <vector>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/observer.hpp"
#include "tests/bridge/fakes.hpp"
#include "tests/catch.hpp"

using antiskid::can::Frame;
using antiskid::can::Role;
using antiskid::can::Time;
using namespace std::chrono_literals;

namespace {

/// A controller's status frames, one each time.
class Sender {
  public:
    explicit Sender(const antiskid::can::Layout& layout) : id_(layout[Role::status].id), port_(layout, 1ms) {}
    Frame next() {
        for (;;) {
            std::array<Frame, antiskid::can::ControllerPort::kMostFrames> frames;
            const std::size_t due = port_.due_frames({}, frames);
            for (std::size_t i = 0; i < due; ++i)
                if (frames[i].id == id_) return frames[i];
        }
    }

  private:
    std::uint16_t id_;
    antiskid::can::ControllerPort port_;
};

struct Ear {
    void hear(Frame frame) {
        now += 5ms;
        frame.received = now;
        (void)observer.accept(frame);
        refused.accept(frame, observer.stats(Role::status));
    }

    antiskid::can::Layout layout = bridge_test::layout();
    antiskid::can::Observer observer{layout};
    rig::RefusedFrames refused{layout, Role::status};
    Time now = 1s;
};

}  // namespace

TEST_CASE("Two controllers are told by their counters, whatever lies between these", "[BRG-461]") {
    for (int apart = 0; apart < 15; ++apart) {
        CAPTURE(apart);
        Ear ear;
        Sender first(ear.layout);
        Sender second(ear.layout);
        for (int i = 0; i < apart; ++i) (void)second.next();
        for (int i = 0; i < 12; ++i) {
            ear.hear(first.next());
            ear.hear(second.next());
        }
        CHECK(ear.refused.two_senders());
        CHECK_THAT(ear.refused.text(ear.now - 100ms),
                   Catch::Matchers::StartsWith("counter; two senders of 0x180, at counters "));
    }
}

TEST_CASE("A controller whose frames are lost, doubled or damaged, or that starts anew, is one",
          "[BRG-461]") {
    Ear ear;
    auto sender = std::make_unique<Sender>(ear.layout);
    for (int i = 0; i < 200; ++i) {
        Frame frame = sender->next();
        if (i % 7 == 0) continue;
        if (i % 11 == 0) ear.hear(frame);
        if (i % 13 == 0) frame.data[1] ^= 0x10U;
        if (i == 100) sender = std::make_unique<Sender>(ear.layout);
        ear.hear(frame);
        CHECK_FALSE(ear.refused.two_senders());
    }
}

TEST_CASE("What was refused is said by its reason, as long as it is news", "[BRG-461]") {
    Ear ear;
    Sender sender(ear.layout);
    ear.hear(sender.next());
    CHECK(ear.refused.text(Time{}).empty());
    Frame damaged = sender.next();
    damaged.data[2] ^= 1U;
    ear.hear(damaged);
    CHECK(ear.refused.text(ear.now) == "CRC");
    CHECK(ear.refused.text(ear.now + 1ns).empty());
    Frame repeated = sender.next();
    ear.hear(repeated);
    ear.hear(repeated);
    CHECK(ear.refused.text(ear.now) == "counter");
    Frame shorter = sender.next();
    shorter.length = 3;
    ear.hear(shorter);
    CHECK(ear.refused.text(ear.now) == "length");
}
