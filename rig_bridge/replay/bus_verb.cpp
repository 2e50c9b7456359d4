#include <fmt/core.h>

#include <memory>
#include <vector>

#include "firmware/host/realtime.hpp"
#include "firmware/host/stop_signals.hpp"
#include "rig_bridge/replay/player.hpp"
#include "rig_bridge/replay/raw_can_sender.hpp"
#include "rig_bridge/replay/replay_verbs.hpp"

namespace rig::replay {

namespace {

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
        (void)open();  // a log that is not there is said before the interface is touched
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
        if (report->stopped) return 130;
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
    settings::existing_file(verb->add_option("LOG", c->log, "bus log, candump format, plain or gzip"))->required();
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
        "Exit status: 0 all sent; 1 some were not, the log cannot be read, or the interface is gone; 2 "
        "mistake on the command "
        "line;\n130 stopped by Ctrl-C.");
    return {verb, [c] { return c->run(); }};
}

}  // namespace rig::replay
