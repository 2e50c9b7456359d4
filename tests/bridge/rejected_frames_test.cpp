// Received and rejected: why.
#include "rig_bridge/bridge/rejected_frames.hpp"

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
            std::array<Frame, antiskid::can::ControllerPort::kMaxFrames> frames;
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
        rejected.accept(frame, observer.stats(Role::status));
    }

    antiskid::can::Layout layout = bridge_test::layout();
    antiskid::can::Observer observer{layout};
    rig::bridge::RejectedFrames rejected{layout, Role::status};
    Time now = 1s;
};

}  // namespace

TEST_CASE("What was refused is said by its reason, as long as it is news", "[BRG-460]") {
    Ear ear;
    Sender sender(ear.layout);
    ear.hear(sender.next());
    CHECK(ear.rejected.reason(Time{}).empty());
    Frame damaged = sender.next();
    damaged.data[2] ^= 1U;
    ear.hear(damaged);
    CHECK(ear.rejected.reason(ear.now) == "CRC");
    CHECK(ear.rejected.reason(ear.now + 1ns).empty());
    Frame repeated = sender.next();
    ear.hear(repeated);
    ear.hear(repeated);
    CHECK(ear.rejected.reason(ear.now) == "counter");
    Frame shorter = sender.next();
    shorter.length = 3;
    ear.hear(shorter);
    CHECK(ear.rejected.reason(ear.now) == "length");
}
