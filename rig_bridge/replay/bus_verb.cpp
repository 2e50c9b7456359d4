#include <fmt/core.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/host/realtime.hpp"
#include "firmware/host/stop_signals.hpp"
#include "rig_bridge/replay/player.hpp"
#include "rig_bridge/replay/replay_verbs.hpp"

namespace rig::replay {

namespace {

[[noreturn]] void reject(const std::string& interface, const std::string& why) {
    throw std::runtime_error("CAN interface '" + interface + "': " + why);
}

bool is_up(int socket, const std::string& interface) {
    ifreq request{};
    std::strncpy(request.ifr_name, interface.c_str(), IFNAMSIZ - 1);
    return ioctl(socket, SIOCGIFFLAGS, &request) == 0 && (static_cast<unsigned>(request.ifr_flags) & IFF_UP) != 0;
}

can_frame as_kernel_frame(const LogFrame& from) {
    can_frame frame{};
    frame.can_id = from.frame.id;
    if (from.extended) frame.can_id |= CAN_EFF_FLAG;
    if (from.remote) frame.can_id |= CAN_RTR_FLAG;
    frame.can_dlc = from.frame.length;
    std::copy(from.frame.data.begin(), from.frame.data.end(), std::begin(frame.data));
    return frame;
}

/// A SocketCAN socket that only sends, any frame that a log may contain: both identifier lengths, data and remote frames.
class RawCanSender final : public FrameSender {
  public:
    /// Throws std::runtime_error naming the interface and the remedy if it is missing, down or not CAN.
    explicit RawCanSender(const std::string& interface) : interface_(interface) {
        const unsigned index = if_nametoindex(interface.c_str());
        if (index == 0) reject(interface, "there is none; for a virtual one: ip link add " + interface + " type vcan");
        socket_ = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
        if (socket_ < 0) reject(interface, std::string("the kernel has no CAN: ") + std::strerror(errno));
        setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_FILTER, nullptr, 0);
        sockaddr_can address{};
        address.can_family = AF_CAN;
        address.can_ifindex = static_cast<int>(index);
        const bool bound = bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
        const int error = errno;
        const bool up = is_up(socket_, interface);
        if (bound && up) return;
        close(socket_);
        if (!bound) reject(interface, std::string("is no CAN interface: ") + std::strerror(error));
        reject(interface, "is down; ip link set " + interface + " up");
    }
    ~RawCanSender() override { close(socket_); }
    RawCanSender(const RawCanSender&) = delete;
    RawCanSender& operator=(const RawCanSender&) = delete;

    /// Waits for room in a full transmit queue, at most kPatience.
    bool send(const LogFrame& from) override {
        constexpr useconds_t kPause_us = 100;
        const can_frame frame = as_kernel_frame(from);
        Time waited{};
        for (;;) {
            if (write(socket_, &frame, sizeof frame) == static_cast<ssize_t>(sizeof frame)) return true;
            if (errno == EINTR) continue;
            if (errno != ENOBUFS && errno != EAGAIN) reject(interface_, std::string("cannot send: ") + std::strerror(errno));
            if (waited >= kPatience) return false;
            usleep(kPause_us);
            waited += std::chrono::microseconds{kPause_us};
        }
    }
    static constexpr Time kPatience{200'000'000};

  private:
    std::string interface_;
    int socket_ = -1;
};

struct BusCommand {
    std::string log;
    std::string can;
    std::string interface;
    double speed = 1.0;
    std::uint64_t loops = 1;
    std::vector<std::string> ids;
    int priority = 0;
    std::string json;

    int run() const {
        PlayOptions options;
        options.speed = speed;
        options.loops = loops;
        configured([&] {
            for (const std::string& id : ids) options.filter.add(id);
            return 0;
        });
        antiskid::host::StopSignals signals;
        LogWarnings warnings = warnings_of(log);
        const OpenLog open = [&] {
            LogOptions of_log;
            if (!interface.empty()) of_log.interface = interface;
            return std::make_unique<LogReader>(log, of_log, warnings);
        };
        (void)open();  // reports a missing log before the interface is opened
        RawCanSender sender(can);
        if (priority > 0) become_realtime();
        antiskid::host::MonotonicClock clock;
        const auto report = std::make_unique<PlayReport>();
        play(open, options, sender, clock, signals.stop(), *report);
        if (json != "-") {
            fmt::print("{}", to_text(*report));
            if (warnings.any()) fmt::print("warnings of the log: {}\n", warnings.summary());
        }
        settings::deliver(json, to_json(*report, log, can));
        if (report->stopped) return signals.exit_status();
        if (report->sent == 0) throw std::runtime_error(log + ": no frame to play (see the warnings above, --interface and --id)");
        return report->unsent == 0 ? 0 : 1;
    }

    void become_realtime() const {
        if (const auto rejected = antiskid::host::lock_memory()) fmt::print(stderr, "rig-replay: {}\n", *rejected);
        for (const std::string& rejected : antiskid::host::enter_realtime({.priority = priority, .cpu = {}}))
            fmt::print(stderr, "rig-replay: {}\n", rejected);
    }
};

}  // namespace

ReplayVerb bus_verb(CLI::App& app) {
    const auto c = std::make_shared<BusCommand>();
    CLI::App* verb = app.add_subcommand("bus", "Plays a log on a CAN interface, every frame at its time.");
    settings::existing_file(verb->add_option("LOG", c->log, "bus log: candump, Vector ASC or BLF, PEAK TRC, plain or gzip"))->required();
    verb->add_option("--can", c->can, "CAN interface to play on, e.g. vcan0")->required()->type_name("IF");
    verb->add_option("--speed", c->speed, "factor: 2 plays twice as fast as recorded")->check(CLI::Range(1e-3, 1e6))->capture_default_str();
    verb->add_option("--loop", c->loops, "how often; 0: until stopped")->check(CLI::NonNegativeNumber)->capture_default_str();
    verb->add_option("--id", c->ids, "only these identifiers, hexadecimal: 110, 100:7F0 (with mask), 18FF0000; may be repeated");
    verb->add_option("--interface", c->interface, "lines of this interface in the log (default: the first one there)");
    verb->add_option("--priority", c->priority, "SCHED_FIFO priority; 0: ordinary scheduling")->check(CLI::Range(0, 99))->capture_default_str();
    settings::add_json(*verb, c->json, "report");
    verb->footer(
        "CAN FD frames and error frames are not sent: they are counted and named.\n"
        "Examples:\n"
        "  rig-replay bus out/landing/bus.log --can vcan0\n"
        "  rig-replay bus candump-2026-11-21.log.gz --can vcan0 --speed 10 --id 110:7F8 --loop 3\n"
        "Exit status: 0 all sent; 1 some were not, the log cannot be read, or the interface is gone; 2 mistake on the command line;\n130 stopped by "
        "Ctrl-C.");
    return {verb, [c] { return c->run(); }};
}

}  // namespace rig::replay
