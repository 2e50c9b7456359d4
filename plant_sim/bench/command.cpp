#include "plant_sim/bench/command.hpp"

#include <chrono>
#include <future>
#include <stdexcept>

#include "firmware/host/clock.hpp"
#include "firmware/host/realtime.hpp"
#include "plant_sim/bench/can_socket.hpp"
#include "plant_sim/bench/child.hpp"
#include "plant_sim/bench/ping_pong.hpp"

namespace antiskid::bench {

namespace {

using namespace std::chrono_literals;
using Samples = std::vector<std::int64_t>;

constexpr std::chrono::seconds kPatience{30};

/// On a thread of its own, so that programs started later do not inherit its priority.
template <typename Work>
auto at_rig_priority(const Settings& s, Work work) {
    return std::async(std::launch::async,
                      [&] {
                          (void)host::enter_realtime({.priority = s.rig_priority(), .cpu = s.cpu});
                          return work();
                      })
        .get();
}

/// One exchange; returns its duration in ns.
std::int64_t exchange(CanSocket& socket, const can_frame& question, can_frame& answer) {
    host::MonotonicClock clock;
    const host::Time before = clock.now();
    socket.send(question);
    if (!socket.receive(answer)) throw std::runtime_error("no answer within " + std::to_string(kPatience.count()) + " s");
    return (clock.now() - before).count();
}

Samples ping_pong(const Settings& s, const std::size_t count) {
    CanSocket socket(s.interface, PongProcess::kPong);
    socket.set_patience(kPatience);
    const PongProcess other(s.interface, {.priority = s.priority, .cpu = s.cpu});
    return at_rig_priority(s, [&] {
        Samples latencies;
        latencies.reserve(count);
        can_frame ping{};
        ping.can_id = PongProcess::kPing;
        ping.can_dlc = 8;
        can_frame pong{};
        (void)exchange(socket, ping, pong);  // until the process runs
        for (std::size_t i = 0; i < count; ++i) latencies.push_back(exchange(socket, ping, pong));
        return latencies;
    });
}

/// Repeats the first cycle until the controller is there.
void first_cycle(CanSocket& socket, const RecordedStop::Cycle& cycle, can_frame& answer) {
    constexpr auto kRepeat = 500ms;
    socket.set_patience(kRepeat);
    for (auto waited = 0ms; waited < kPatience; waited += kRepeat) {
        for (const can_frame& frame : cycle.sensors) socket.send(frame);
        socket.send(cycle.sync);
        if (!socket.receive(answer)) continue;
        socket.set_patience(kPatience);
        return;
    }
    throw std::runtime_error("antiskid-controller did not answer within " + std::to_string(kPatience.count()) + " s");
}

Samples replay(const Settings& s, const RecordedStop& stop, std::uint64_t& unlike_recorded) {
    CanSocket socket(s.interface, stop.valve_id);
    Child controller({s.controller, "--can", s.interface, "--clock", "sync", "--sync-timeout", "60000", "--priority", std::to_string(s.priority),
                      "--cpu", std::to_string(s.cpu), "--log-level", "warning"},
                     s.log());
    Samples latencies = at_rig_priority(s, [&] {
        Samples durations;
        durations.reserve(stop.cycles.size());
        can_frame answer{};
        first_cycle(socket, stop.cycles.front(), answer);
        for (std::size_t i = 1; i < stop.cycles.size(); ++i) {
            const RecordedStop::Cycle& cycle = stop.cycles[i];
            for (const can_frame& frame : cycle.sensors) socket.send(frame);
            durations.push_back(exchange(socket, cycle.sync, answer));
            if (!same(answer, cycle.valve)) ++unlike_recorded;
        }
        return durations;
    });
    controller.stop();
    controller.expect_success();
    return latencies;
}

double clock_reading_us() {
    host::MonotonicClock clock;
    Samples durations;
    for (int i = 0; i < 1000; ++i) {
        const host::Time before = clock.now();
        durations.push_back((clock.now() - before).count());
    }
    return exact(durations).p50_us;
}

}  // namespace

CommandLatency measure_command(const Settings& settings, const RecordedStop& stop, const std::function<void(int, const CommandRound&)>& on_round) {
    CommandLatency all;
    Samples controller;
    Samples bare;
    for (int number = 1; number <= settings.rounds; ++number) {
        CommandRound round;
        Samples of_bare = ping_pong(settings, stop.cycles.size());
        Samples of_controller = replay(settings, stop, round.unlike_recorded);
        bare.insert(bare.end(), of_bare.begin(), of_bare.end());
        controller.insert(controller.end(), of_controller.begin(), of_controller.end());
        round.ping_pong = exact(of_bare);
        round.controller = exact(of_controller);
        on_round(number, round);
        all.rounds.push_back(round);
    }
    all.ping_pong = exact(bare);
    all.controller = exact(controller);
    all.clock_reading_us = clock_reading_us();
    return all;
}

}  // namespace antiskid::bench
