#include "plant_sim/bench/command.hpp"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <exception>
#include <future>
#include <iterator>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "firmware/can/roles.hpp"
#include "firmware/host/clock.hpp"
#include "firmware/host/realtime.hpp"
#include "plant_sim/bench/child.hpp"
#include "plant_sim/study/in_process.hpp"

namespace antiskid::bench {

namespace {

/// The least that a program on SocketCAN can do: a blocking raw socket that receives one identifier.
class CanSocket {
  public:
    /// Throws std::runtime_error naming the interface when it cannot be had.
    CanSocket(const std::string& interface, const canid_t wanted) : descriptor_(socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW)) {
        if (descriptor_ >= 0) {
            const can_filter filter{.can_id = wanted, .can_mask = CAN_EFF_FLAG | CAN_RTR_FLAG | CAN_SFF_MASK};
            sockaddr_can address{};
            address.can_family = AF_CAN;
            address.can_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
            if (address.can_ifindex > 0 && setsockopt(descriptor_, SOL_CAN_RAW, CAN_RAW_FILTER, &filter, sizeof filter) == 0 &&
                bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0)
                return;
        }
        const std::string reason = std::generic_category().message(errno);
        if (descriptor_ >= 0) close(descriptor_);
        throw std::runtime_error("CAN interface '" + interface + "': " + reason + "; `./rig vcan -- COMMAND` gives a command a vcan0");
    }
    ~CanSocket() { close(descriptor_); }
    CanSocket(const CanSocket&) = delete;
    CanSocket& operator=(const CanSocket&) = delete;

    /// Longest that receive() waits; at first for ever.
    void set_patience(const std::chrono::milliseconds patience) {
        const auto ms = patience.count();
        const timeval limit{.tv_sec = ms / 1000, .tv_usec = ms % 1000 * 1000};
        if (setsockopt(descriptor_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit) != 0)
            throw std::system_error(errno, std::generic_category(), "time-out of a CAN socket");
    }
    /// Throws std::system_error when the interface does not take it.
    void send(const can_frame& frame) {
        if (write(descriptor_, &frame, sizeof frame) != static_cast<ssize_t>(sizeof frame))
            throw std::system_error(errno, std::generic_category(), "sending a CAN frame");
    }
    /// False when none came in time. Throws std::system_error when none can come.
    [[nodiscard]] bool receive(can_frame& frame) {
        if (read(descriptor_, &frame, sizeof frame) == static_cast<ssize_t>(sizeof frame)) return true;
        if (errno != EAGAIN) throw std::system_error(errno, std::generic_category(), "receiving a CAN frame");
        return false;
    }

  private:
    int descriptor_;
};

constexpr canid_t kPing = 0x7F0;
constexpr canid_t kPong = 0x7F1;

[[noreturn]] void answer(CanSocket& socket, const host::RealtimeRequest& request) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    (void)host::lock_memory();
    (void)host::enter_realtime(request);
    try {
        for (can_frame frame{}; socket.receive(frame);) {
            frame.can_id = kPong;
            socket.send(frame);
        }
    } catch (const std::exception&) {
        _exit(1);
    }
    _exit(1);
}

/// The bare other side of a SocketCAN ping-pong: a process that answers each ping with a pong.
class PongProcess {
  public:
    /// Ready to answer when this returns. Throws when it cannot be.
    PongProcess(const std::string& interface, const host::RealtimeRequest& request) : pid_(-1) {
        // Opened before the fork: a ping that comes before the process runs waits in the socket.
        CanSocket socket(interface, kPing);
        pid_ = fork();
        if (pid_ < 0) throw std::system_error(errno, std::generic_category(), "fork");
        if (pid_ == 0) answer(socket, request);
    }
    /// Ends it.
    ~PongProcess() {
        kill(pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }
    PongProcess(const PongProcess&) = delete;
    PongProcess& operator=(const PongProcess&) = delete;

  private:
    int pid_;
};

using namespace std::chrono_literals;
using Samples = std::vector<std::int64_t>;

constexpr std::chrono::seconds kAnswerTimeout{30};

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
    if (!socket.receive(answer)) throw std::runtime_error("no answer within " + std::to_string(kAnswerTimeout.count()) + " s");
    return (clock.now() - before).count();
}

Samples ping_pong(const Settings& s, const std::size_t count) {
    CanSocket socket(s.interface, kPong);
    socket.set_patience(kAnswerTimeout);
    const PongProcess other(s.interface, {.priority = s.priority, .cpu = s.cpu});
    return at_rig_priority(s, [&] {
        Samples latencies;
        latencies.reserve(count);
        can_frame ping{};
        ping.can_id = kPing;
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
    for (auto waited = 0ms; waited < kAnswerTimeout; waited += kRepeat) {
        for (const can_frame& frame : cycle.sensors) socket.send(frame);
        socket.send(cycle.sync);
        if (!socket.receive(answer)) continue;
        socket.set_patience(kAnswerTimeout);
        return;
    }
    throw std::runtime_error("antiskid-controller did not answer within " + std::to_string(kAnswerTimeout.count()) + " s");
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

can_frame raw(const can::Frame& frame) {
    can_frame out{};
    out.can_id = frame.id;
    out.can_dlc = frame.length;
    std::copy(frame.data.begin(), frame.data.end(), std::begin(out.data));
    return out;
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

RecordedStop record_stop(const plant_sim::StopInputs& scenario) {
    RecordedStop stop{.valve_id = scenario.layout[can::Role::valve].id, .cycles = {}};
    const std::uint32_t sync_id = scenario.layout[can::Role::sync].id;
    const can::IdList of_controller = can::ids(scenario.layout, can::kToRig);
    RecordedStop::Cycle cycle;
    const auto on_frame = [&](const can::Frame& frame) {
        if (frame.id == sync_id) {
            cycle.sync = raw(frame);
        } else if (frame.id == stop.valve_id) {
            cycle.valve = raw(frame);
            stop.cycles.push_back(std::exchange(cycle, {}));
        } else if (std::ranges::count(of_controller.span(), frame.id) == 0) {
            cycle.sensors.push_back(raw(frame));
        }
    };
    (void)study::run_in_process(scenario.controller, scenario.layout, scenario.plant.rig, scenario.session, study::Link::frames, {}, on_frame);
    return stop;
}

bool same(const can_frame& a, const can_frame& b) {
    return a.can_id == b.can_id && a.can_dlc == b.can_dlc && std::memcmp(a.data, b.data, a.can_dlc) == 0;
}

}  // namespace antiskid::bench
