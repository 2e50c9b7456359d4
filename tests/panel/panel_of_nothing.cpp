/// A panel with made signals, an alarm that comes and goes, a campaign that waits for its start, and an abort that is only counted: for the
/// browser's test. Until SIGTERM.

#include <fmt/core.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <thread>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/stop_signals.hpp"
#include "rig_bridge/panel/server.hpp"

namespace {

int run() {
    using rig::panel::Signal;
    antiskid::host::StopSignals stops;
    std::atomic<int> aborts{0};
    std::atomic<const char*> campaign{"waits"};
    rig::panel::LiveFeed feed;
    rig::panel::ServerOptions options{
        .address = rig::panel::parse_address("127.0.0.1:0"),
        .about = {.title = "made signals", .simulated = true, .views = {"live"}, .emergency_stop = "It is the red button at the rig."}};
    options.changes["abort"] = [&aborts](const rig::panel::Query&) { return settings::Json{{"said", fmt::format("aborts: {}", ++aborts)}}.dump(); };
    const auto becomes = [&campaign](const char* standing) {
        return [&campaign, standing](const rig::panel::Query&) {
            campaign = standing;
            return settings::Json{{"said", standing}}.dump();
        };
    };
    options.changes["hold"] = becomes("held");
    options.changes["resume"] = becomes("runs");
    const rig::panel::Server server(options, &feed);
    fmt::print("{}\n", server.greeting());
    (void)std::fflush(stdout);
    for (int step = 0; stops.count() == 0; ++step) {
        const double t = 1e-2 * step;
        rig::panel::LiveSample sample;
        sample.time_s = t;
        sample[Signal::rim] = 60.0 - 3.0 * std::fmod(t, 15.0);
        sample[Signal::wheel] = sample[Signal::rim] * 0.76;
        sample[Signal::slip] = 0.24 + 0.02 * std::sin(9.0 * t);
        sample[Signal::slip_reference] = 0.24;
        sample[Signal::demand] = 2.0e7;
        sample[Signal::pressure] = 1.4e7 + 4e5 * std::sin(7.0 * t);
        sample[Signal::current] = 12.0 + std::sin(8.0 * t);
        sample[Signal::load] = 3.9e4;
        sample[Signal::temperature] = 20.0 + t;
        feed.sample(sample);
        if (feed.state_due(t)) {
            settings::Json state{{"facts", {{"phase", "braking"}, {"controller", "controlling <b>"}}},
                                 {"interlocks", {{"guard closed", aborts == 0}, {"drive healthy", true}}},
                                 {"alarms", settings::Json::array()},
                                 {"campaign", campaign.load()}};
            if (aborts > 0)
                state["alarms"].push_back(
                    {{"name", "abort: operator"}, {"happened", "you asked for it"}, {"next", "start again when you are ready"}});
            feed.state([text = state.dump()] { return text; }, t);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return 0;
}

}  // namespace

int main() {
    try {
        return run();
    } catch (const std::exception& error) {
        std::fprintf(stderr, "panel_of_nothing: %s\n", error.what());
        return 1;
    }
}
