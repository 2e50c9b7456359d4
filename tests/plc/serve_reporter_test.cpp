/// What is said of a running node, from another thread than the node's.
#include "plant_sim/virtual_rig/serve_reporter.hpp"

#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/can/load_layout.hpp"
#include "firmware/can/loopback.hpp"
#include "tests/catch.hpp"
#include "tests/plc/operator.hpp"

namespace {

/// The near end of a loopback as a bus of its own.
class Near final : public antiskid::can::Bus {
  public:
    explicit Near(antiskid::can::Loopback::End& end) : end_(end) {}
    std::size_t receive(std::span<antiskid::can::Frame> frames) override { return end_.receive(frames); }
    bool send(const antiskid::can::Frame& frame) override { return end_.send(frame); }
    bool wait(antiskid::control::Time timeout) override { return end_.wait(timeout); }
    [[nodiscard]] antiskid::can::LinkStatus status() const override { return end_.status(); }

  private:
    antiskid::can::Loopback::End& end_;
};

}  // namespace

TEST_CASE("refusal, trip, reset, a lost interface and its return are said once each, in order", "[RIG-270]") {
    using plc_test::Operator;
    const auto layout = antiskid::can::load_layout("config/antiskid.dbc", "config/antiskid_binding.toml");
    Operator op(plc::Bench::endurance);
    antiskid::can::Loopback hub;
    antiskid::can::Loopback::End& end = hub.connect();
    // The first bus dies; the second is there at the third attempt.
    int opened = 0;
    antiskid::host::SupervisedCan bus([&]() -> std::unique_ptr<antiskid::can::Bus> {
        if (++opened == 2 || opened == 3) throw std::runtime_error("can7 does not exist");
        return std::make_unique<Near>(opened == 1 ? end : hub.connect());
    });

    std::mutex mutex;
    std::vector<std::string> said;
    const auto has_said = [&](const std::string& what) {
        const std::lock_guard lock(mutex);
        return std::count_if(said.begin(), said.end(), [&what](const std::string& line) { return line.find(what) != std::string::npos; });
    };

    std::atomic<bool> stop{false};
    int act = 0;
    antiskid::host::MonotonicClock clock;
    constexpr antiskid::control::Time kStep{1'000'000};
    // Each act begins when the last one has been reported, however long that takes.
    const auto play = [&](plc::ServedRig& rig) {
        if (op.rig.plc().watchdog() % 10 == 0) rig::at(op.registers, rig::Commanded::bridge_watchdog) += 1.0;
        rig.command(op.registers);
        if (act == 0) {
            op.wish({.drive = true, .speed_mps = 1000.0});
            act = 1;
        } else if (act == 1 && has_said("PLC refused commit 1: out of range") == 1) {
            rig.open_interlocks(1U);
            act = 2;
        } else if (act == 2 && has_said("PLC tripped: emergency stop") == 1) {
            rig.open_interlocks(0U);
            op.wish({.reset = true});
            act = 3;
        } else if (act == 3 && has_said("PLC reset: ready") == 1) {
            end.set_link(false, false);
            act = 4;
        } else if (act == 4 && has_said("can7 is up again") == 1) {
            stop = true;
        }
    };
    plant_sim::ServeNode node(op.rig, layout, bus, clock, kStep, play);
    {
        const plant_sim::ServeReporter reporter(node, bus, "can7", 1e-3, [&](const std::string& line) {
            const std::lock_guard lock(mutex);
            said.push_back(line);
        });
        node.run_realtime(stop);
    }
    CHECK(has_said("can7 does not exist") == 1);
    CHECK(has_said("can7 is down") == 1);
    CHECK(has_said(" s: ") == static_cast<long>(said.size()));
    CHECK(said.size() == 6);
    CHECK(opened == 4);
}
