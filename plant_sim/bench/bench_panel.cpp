/// What a panel costs the loop of a served rig (1 ms) and the bridge's main loop (10 ms): without one, with one that nobody looks at, and with 20
/// viewers, one of whom reads nothing. In turns, each for 2,000 periods of real time; with SCHED_FIFO where that is allowed, as the programs are run.
/// The bridge's PLC and bus are objects that answer at once: its client and recorder have threads of their own. Table on standard output, JSON in
/// out/bench/panel.json; five minutes and a half.

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "firmware/host/periodic_timer.hpp"
#include "firmware/host/realtime.hpp"
#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/file_descriptor.hpp"
#include "firmware/host/settings/json.hpp"
#include "plant_sim/bench/measure.hpp"
#include "plant_sim/bench/percentiles.hpp"
#include "plant_sim/plc/load_served_rig.hpp"
#include "plant_sim/virtual_rig/serve_panel.hpp"
#include "rig_bridge/bridge/panel_state.hpp"
#include "rig_bridge/bridge/view_model.hpp"
#include "rig_bridge/rig/scenario.hpp"
#include "tests/bridge/fakes.hpp"

namespace {

using antiskid::bench::Percentiles;
using antiskid::can::Time;

constexpr int kPeriods = 2000;
constexpr int kRounds = 5;

/// Looks on until it is destroyed.
class Viewer {
  public:
    Viewer(int port, bool reads) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        sockaddr_in to{
            .sin_family = AF_INET, .sin_port = htons(static_cast<std::uint16_t>(port)), .sin_addr = {htonl(INADDR_LOOPBACK)}, .sin_zero = {}};
        if (::connect(socket_.get(), reinterpret_cast<sockaddr*>(&to), sizeof to) != 0) throw std::runtime_error("no connection to the panel");
        const std::string ask = fmt::format("GET /events HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n", port);
        if (::send(socket_.get(), ask.data(), ask.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(ask.size())) throw std::runtime_error("not asked");
        if (reads) thread_ = std::thread([this] { read(); });
    }
    ~Viewer() {
        ::shutdown(socket_.get(), SHUT_RDWR);
        if (thread_.joinable()) thread_.join();
    }
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;
    [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

  private:
    void read() {
        std::vector<char> buffer(65536);
        for (ssize_t count = 1; count > 0;) {
            count = ::recv(socket_.get(), buffer.data(), buffer.size(), 0);
            if (count > 0) bytes_ += static_cast<std::uint64_t>(count);
        }
    }

    settings::FileDescriptor socket_;
    std::atomic<std::uint64_t> bytes_{0};
    std::thread thread_;
};

/// From the beginning of a period.
struct Latencies {
    std::vector<std::int64_t> woken_ns, done_ns;
};

/// What is measured: a program's loop, with its panel where it is given one.
class Loop {
  public:
    Loop(const char* name, std::chrono::milliseconds period) : name_(name), period_(period) {}
    virtual ~Loop() = default;
    Loop(const Loop&) = delete;
    Loop& operator=(const Loop&) = delete;

    [[nodiscard]] const char* name() const { return name_; }
    [[nodiscard]] std::chrono::milliseconds period() const { return period_; }
    virtual void give_panel(bool panel) = 0;
    [[nodiscard]] virtual int port() const = 0;
    virtual void step(Time now) = 0;

  private:
    const char* name_;
    std::chrono::milliseconds period_;
};

class ServedLoop final : public Loop {
  public:
    ServedLoop()
        : Loop("virtual-rig serve", std::chrono::milliseconds(1)),
          rig_(rig::load_scenario("config/scenarios/heavy.toml").rig, plc::load_served_rig("config", plc::Bench::landing), 1) {}
    void give_panel(bool panel) override {
        panel_.reset();
        if (panel) panel_.emplace("127.0.0.1:0", "benchmark");
    }
    [[nodiscard]] int port() const override { return panel_->port(); }
    void step(Time) override {
        rig_.advance(0.0);
        if (panel_) panel_->show(rig_, state_);
    }

  private:
    plc::ServedRig rig_;
    plant_sim::ServeState state_;
    std::optional<plant_sim::ServePanel> panel_;
};

struct BridgePanel {
    rig::panel::LiveFeed feed;
    rig::panel::Server server{{.address = rig::panel::parse_address("127.0.0.1:0"), .about = {.title = "benchmark", .views = {"live"}}}, &feed};
};

class BridgeLoop final : public Loop {
  public:
    BridgeLoop() : Loop("rig-bridge", std::chrono::duration_cast<std::chrono::milliseconds>(rig::bridge::Node::kStep)) {}
    void give_panel(bool panel) override {
        panel_.reset();
        if (panel) panel_.emplace();
    }
    [[nodiscard]] int port() const override { return panel_->server.port(); }
    void step(Time now) override {
        bus_.sent.clear();
        plc_.commands.clear();
        heard_.bus.valid_at = heard_.bus.view.controller.status_received = now;
        heard_.bus.view.wheel.received = heard_.bus.view.flywheel.received = heard_.bus.view.pressure.received = now;
        const rig::bridge::Moment& moment = node_.step(nullptr, {}, now);
        if (!panel_) return;
        const double now_s = std::chrono::duration<double>(now).count();
        panel_->feed.sample(rig::bridge::live_sample(moment));
        if (!panel_->feed.state_due(now_s)) return;
        panel_->feed.state(
            [view = rig::bridge::view_of(moment, node_.limits()), moment] { return rig::bridge::panel_state(view, moment, std::nullopt); }, now_s);
    }

  private:
    antiskid::can::Layout layout_ = bridge_test::layout();
    bridge_test::FakePlc plc_;
    bridge_test::FakeFeed heard_;
    bridge_test::FakeBus bus_;
    rig::bridge::Node node_{layout_, 1e-3, rig::bridge::Freshness{}, plc_, heard_, bus_};
    std::optional<BridgePanel> panel_;
};

/// Returns what the machine refuses of its priority.
std::string run_loop(Loop& measured, Latencies& out) {
    std::string refused;
    std::thread loop([&] {  // a thread of its own: the panel's must not inherit its priority
        for (const std::string& one : antiskid::host::enter_realtime({})) refused += one;
        antiskid::host::MonotonicClock clock;
        antiskid::host::PeriodicTimer timer(clock, measured.period());
        for (int i = 0; i < kPeriods; ++i) {
            const auto tick = timer.wait();
            measured.step(tick.woke);
            out.woken_ns.push_back(tick.latency.count());
            out.done_ns.push_back((clock.now() - tick.woke + tick.latency).count());
        }
    });
    loop.join();
    return refused;
}

struct Variant {
    const char* name;
    bool panel;
    int viewers;
    Percentiles woken, done;
    std::vector<Percentiles> woken_rounds{}, done_rounds{};
};

settings::Json json_of(const Percentiles& p) {
    return {{"periods", p.count}, {"p50_us", p.p50_us}, {"p99_us", p.p99_us}, {"p99_9_us", p.p99_9_us}, {"max_us", p.max_us}};
}

void run_once(Loop& loop, Variant& variant, std::string& refused) {
    loop.give_panel(variant.panel);
    std::vector<std::unique_ptr<Viewer>> viewers;
    viewers.reserve(static_cast<std::size_t>(variant.viewers));
    for (int i = 0; i < variant.viewers; ++i) viewers.push_back(std::make_unique<Viewer>(loop.port(), i > 0));
    Latencies latencies;
    refused = run_loop(loop, latencies);
    for (const auto& viewer : viewers)
        if (viewer != viewers.front() && viewer->bytes() == 0) throw std::runtime_error("a viewer was shown nothing");
    viewers.clear();
    variant.woken_rounds.push_back(antiskid::bench::exact(latencies.woken_ns));
    variant.done_rounds.push_back(antiskid::bench::exact(latencies.done_ns));
}

settings::Json measure(Loop& loop) {
    std::vector<Variant> variants{{.name = "no panel", .panel = false, .viewers = 0, .woken = {}, .done = {}},
                                  {.name = "panel, no viewer", .panel = true, .viewers = 0, .woken = {}, .done = {}},
                                  {.name = "panel, 20 viewers", .panel = true, .viewers = rig::panel::Server::kViewers, .woken = {}, .done = {}}};
    std::string refused;
    for (int round = 0; round < kRounds; ++round)
        for (Variant& variant : variants) run_once(loop, variant, refused);
    loop.give_panel(false);
    settings::Json report{{"loop", loop.name()}, {"priority", refused.empty() ? "SCHED_FIFO" : refused}, {"rounds", kRounds}};
    fmt::print("{}: a period of {} ms, us from its beginning, medians of {} rounds of {} periods{}{}\n", loop.name(), loop.period().count(), kRounds,
               kPeriods, refused.empty() ? "" : "; without priority: ", refused);
    fmt::print("{:18}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "", "woken p50", "p99.9", "end p50", "end p99", "end p99.9");
    for (Variant& variant : variants) {
        variant.woken = antiskid::bench::median(variant.woken_rounds);
        variant.done = antiskid::bench::median(variant.done_rounds);
        fmt::print("{:18}{:10.1f}{:10.1f}{:10.1f}{:10.1f}{:10.1f}\n", variant.name, variant.woken.p50_us, variant.woken.p99_9_us, variant.done.p50_us,
                   variant.done.p99_us, variant.done.p99_9_us);
        report["variants"].push_back({{"name", variant.name}, {"woken", json_of(variant.woken)}, {"done", json_of(variant.done)}});
    }
    const double ratio = variants.back().done.p99_9_us / variants.front().done.p99_9_us;
    fmt::print("end of the period at p99.9: with 20 viewers over without a panel {:.3f}\n", ratio);
    report["p99_9_with_viewers_over_without_panel"] = ratio;
    return report;
}

int run() {
    ServedLoop served;
    BridgeLoop bridge;
    const settings::Json report{{"version", ANTISKID_VERSION}, {"loops", {measure(served), measure(bridge)}}};
    settings::write_file("out/bench/panel.json", report.dump(2) + "\n");
    return 0;
}

}  // namespace

int main() {
    return bench::status_of("bench_panel", run);
}
