#include "plant_sim/bench/results.hpp"

#include <fmt/format.h>
#include <sys/utsname.h>

#include <iterator>
#include <string_view>

namespace antiskid::bench {

namespace {

using Json = nlohmann::ordered_json;

Json as_json(const Percentiles& p) {
    return {{"count", p.count}, {"p50_us", p.p50_us}, {"p99_us", p.p99_us}, {"p99_9_us", p.p99_9_us}, {"max_us", p.max_us}};
}

Json ratio(const Percentiles& ours, const Percentiles& theirs) {
    return {{"p50", ours.p50_us / theirs.p50_us}, {"p99", ours.p99_us / theirs.p99_us}, {"p99_9", ours.p99_9_us / theirs.p99_9_us}};
}

template <typename Round>
Percentiles middle(const std::vector<Round>& rounds, Percentiles Round::*of) {
    std::vector<Percentiles> all;
    all.reserve(rounds.size());
    for (const Round& round : rounds) all.push_back(round.*of);
    return median(all);
}

Json wake_up_json(const std::vector<WakeUpRound>& rounds) {
    Json each = Json::array();
    for (const WakeUpRound& round : rounds)
        each.push_back({{"controller", as_json(round.controller)},
                        {"cyclictest", as_json(round.cyclictest)},
                        {"edge_by_sensors", as_json(round.edge_by_sensors)},
                        {"edge_by_timer", as_json(round.edge_by_timer)},
                        {"frames_received", round.frames_received},
                        {"faults", round.faults},
                        {"cut_short", round.cut_short}});
    const Percentiles ours = middle(rounds, &WakeUpRound::controller);
    const Percentiles theirs = middle(rounds, &WakeUpRound::cyclictest);
    return {{"median",
             {{"controller", as_json(ours)},
              {"cyclictest", as_json(theirs)},
              {"ratio", ratio(ours, theirs)},
              {"edge_by_sensors", as_json(middle(rounds, &WakeUpRound::edge_by_sensors))},
              {"edge_by_timer", as_json(middle(rounds, &WakeUpRound::edge_by_timer))}}},
            {"rounds", each}};
}

Json command_json(const CommandLatency& command) {
    Json each = Json::array();
    for (const CommandRound& round : command.rounds)
        each.push_back(
            {{"controller", as_json(round.controller)}, {"ping_pong", as_json(round.ping_pong)}, {"unlike_recorded", round.unlike_recorded}});
    return {{"all",
             {{"controller", as_json(command.controller)},
              {"ping_pong", as_json(command.ping_pong)},
              {"ratio", ratio(command.controller, command.ping_pong)}}},
            {"clock_reading_us", command.clock_reading_us},
            {"rounds", each}};
}

void add_rows(std::string& text, std::string_view title, std::string_view our_name, const Percentiles& ours, std::string_view their_name,
              const Percentiles& theirs) {
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "{:<44}{:>9}{:>9}{:>9}{:>9}{:>10}\n", title, "p50", "p99", "p99.9", "max", "count");
    for (const auto& [name, p] : {std::pair{our_name, ours}, std::pair{their_name, theirs}})
        fmt::format_to(out, "  {:<42}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.1f}{:>10}\n", name, p.p50_us, p.p99_us, p.p99_9_us, p.max_us, p.count);
    fmt::format_to(out, "  {:<42}{:>9.2f}{:>9.2f}{:>9.2f}\n", "ratio", ours.p50_us / theirs.p50_us, ours.p99_us / theirs.p99_us,
                   ours.p99_9_us / theirs.p99_9_us);
}

}  // namespace

std::string table(const Results& results) {
    std::string text;
    if (!results.wake_up.empty()) {
        add_rows(text, fmt::format("wake-up latency, us, median of {} rounds", results.wake_up.size()), "antiskid-controller by its timer",
                 middle(results.wake_up, &WakeUpRound::controller), "cyclictest", middle(results.wake_up, &WakeUpRound::cyclictest));
        add_rows(text, fmt::format("edge to command, us, median of {} rounds", results.wake_up.size()), "steps by the sensors' frame",
                 middle(results.wake_up, &WakeUpRound::edge_by_sensors), "steps by the timer", middle(results.wake_up, &WakeUpRound::edge_by_timer));
    }
    if (results.command) {
        const CommandLatency& c = *results.command;
        add_rows(text, fmt::format("command latency, us, all of {} rounds", c.rounds.size()), "SYNC to valve command", c.controller,
                 "bare SocketCAN ping-pong", c.ping_pong);
        std::uint64_t unlike = 0;
        for (const CommandRound& round : c.rounds) unlike += round.unlike_recorded;
        fmt::format_to(std::back_inserter(text), "  each contains one clock reading of {:.1f} us; answers unlike the recorded stop: {}\n",
                       c.clock_reading_us, unlike);
    }
    for (const std::string& failure : results.failures) text += "NOT MEASURED: " + failure + "\n";
    return text;
}

std::string json(const Settings& settings, const Results& results) {
    utsname system{};
    uname(&system);
    Json root{{"version", ANTISKID_VERSION},
              {"kernel", fmt::format("{} {} {}", system.sysname, system.release, system.machine)},
              {"interface", settings.interface},
              {"priority", settings.priority},
              {"cpu", settings.cpu},
              {"seconds_a_round", settings.seconds},
              {"wake_up", nullptr},
              {"command", nullptr},
              {"failures", results.failures}};
    if (!results.wake_up.empty()) root["wake_up"] = wake_up_json(results.wake_up);
    if (results.command) root["command"] = command_json(*results.command);
    return root.dump(2) + "\n";
}

}  // namespace antiskid::bench
