#include "firmware/host/supervised_can.hpp"

#include <atomic>
#include <memory>
#include <stdexcept>
#include <thread>

#include "tests/catch.hpp"

namespace can = antiskid::can;
using antiskid::host::SupervisedCan;

namespace {

/// A socket whose fate the test decides.
struct Wire {
    std::atomic<bool> up{true};
    std::atomic<bool> bus_off{false};
    std::atomic<int> sent{0};
    std::atomic<bool> closed{false};
    std::atomic<std::uint32_t> malformed{0};
};

class WireBus final : public can::Bus {
  public:
    explicit WireBus(std::shared_ptr<Wire> wire) : wire_(std::move(wire)) {}
    ~WireBus() override { wire_->closed = true; }
    WireBus(const WireBus&) = delete;
    WireBus& operator=(const WireBus&) = delete;
    std::size_t receive(std::span<can::Frame>) override { return 0; }
    bool send(const can::Frame&) override {
        if (wire_->up) ++wire_->sent;
        return wire_->up;
    }
    bool wait(can::Time) override { return false; }
    [[nodiscard]] can::LinkStatus status() const override {
        return {.up = wire_->up && !wire_->bus_off, .bus_off = wire_->bus_off, .malformed = wire_->malformed};
    }

  private:
    std::shared_ptr<Wire> wire_;
};

/// Hands out one wire after another; refuses while there is no interface.
struct Interface {
    bool present = true;
    std::vector<std::shared_ptr<Wire>> wires;

    SupervisedCan::Open open() {
        return [this]() -> std::unique_ptr<can::Bus> {
            if (!present) throw std::runtime_error("no such interface");
            wires.push_back(std::make_shared<Wire>());
            return std::make_unique<WireBus>(wires.back());
        };
    }
};

}  // namespace

TEST_CASE("an interface that is absent at the start is an error", "[RT-040]") {
    Interface interface {
        .present = false, .wires = {}
    };
    CHECK_THROWS_WITH(SupervisedCan(interface.open()), ContainsSubstring("no such interface"));
}

TEST_CASE("an interface that vanishes is opened anew once it is back", "[RT-040]") {
    Interface interface;
    SupervisedCan bus(interface.open());
    bus.receive({});
    CHECK(bus.service().empty());
    CHECK(interface.wires.size() == 1);  // nothing to do while all is well

    interface.wires[0]->malformed = 5;
    interface.wires[0]->up = false;
    interface.present = false;
    bus.receive({});
    CHECK(bus.lost());
    CHECK_FALSE(bus.send({}));
    CHECK(bus.service() == "no such interface");

    interface.present = true;
    CHECK(bus.service().empty());
    CHECK(interface.wires.size() == 2);
    CHECK(bus.service().empty());
    CHECK(interface.wires.size() == 2);  // the one at the door is taken first
    bus.receive({});
    CHECK(bus.send({}));
    CHECK(interface.wires[1]->sent == 1);
    CHECK(bus.status().up);
    CHECK(bus.status().malformed == 5);       // counts go on
    CHECK_FALSE(interface.wires[0]->closed);  // not by the loop's thread
    CHECK(bus.service().empty());
    CHECK(interface.wires[0]->closed);
    CHECK_FALSE(bus.lost());
}

TEST_CASE("bus-off is left to the kernel: a new socket would only hide it", "[RT-040]") {
    Interface interface;
    SupervisedCan bus(interface.open());
    interface.wires[0]->bus_off = true;
    bus.receive({});
    CHECK_FALSE(bus.lost());
    CHECK(bus.service().empty());
    CHECK(interface.wires.size() == 1);
    CHECK(bus.status().bus_off);
}

TEST_CASE("what is left at the door when the program ends is closed, too", "[RT-040]") {
    Interface interface;
    const bool taken = GENERATE(false, true);
    {
        SupervisedCan bus(interface.open());
        interface.wires[0]->up = false;
        bus.receive({});
        CHECK(bus.service().empty());
        if (taken) bus.receive({});
    }
    REQUIRE(interface.wires.size() == 2);
    CHECK(interface.wires[0]->closed);
    CHECK(interface.wires[1]->closed);
}

// For the thread sanitizer: the loop's thread and the other one, with the interface coming and going.
TEST_CASE("loop and supervisor on two threads", "[RT-040]") {
    Interface interface;
    interface.wires.reserve(10'000);
    SupervisedCan bus(interface.open());
    std::atomic<bool> stop{false};
    std::atomic<std::size_t> newest{0};
    std::thread loop([&] {
        while (!stop) {
            bus.receive({});
            bus.send({});
            std::this_thread::yield();
        }
    });
    for (int i = 0; i < 500; ++i) {
        interface.wires[newest]->up = false;
        while (interface.wires.size() == newest + 1) {
            CHECK(bus.service().empty());
            std::this_thread::yield();
        }
        newest = interface.wires.size() - 1;
        while (interface.wires[newest]->sent == 0) std::this_thread::yield();
        CHECK(bus.service().empty());
    }
    stop = true;
    loop.join();
    CHECK(interface.wires.size() >= 501);
}
