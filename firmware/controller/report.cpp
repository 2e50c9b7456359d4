#include "firmware/controller/report.hpp"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <chrono>
#include <iterator>
#include <string_view>

#include "firmware/can/names.hpp"
#include "firmware/can/roles.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"

namespace antiskid::controller {

namespace {

struct NamedHistogram {
    std::string_view name;
    const host::Histogram& histogram;
};

std::array<NamedHistogram, 5> histograms(const host::LoopStatistics& loop) {
    return {{{"period", loop.period},
             {"latency", loop.latency},
             {"work", loop.work},
             {"edge_to_command", loop.edge_to_command},
             {"overrun", loop.overrun}}};
}

double in_us(const control::Time time) {
    return std::chrono::duration<double, std::micro>(time).count();
}

settings::Json as_json(const host::Histogram& histogram) {
    return {{"count", histogram.count()},
            {"min_ns", histogram.minimum().count()},
            {"mean_ns", histogram.mean_ns()},
            {"p50_ns", histogram.percentile(0.5).count()},
            {"p90_ns", histogram.percentile(0.9).count()},
            {"p99_ns", histogram.percentile(0.99).count()},
            {"p99_9_ns", histogram.percentile(0.999).count()},
            {"p99_99_ns", histogram.percentile(0.9999).count()},
            {"max_ns", histogram.maximum().count()}};
}

settings::Json as_json(const can::MessageStats& stats) {
    return {{"accepted", stats.accepted},         {"lost", stats.lost},
            {"wrong_crc", stats.wrong_crc},       {"wrong_counter", stats.wrong_counter},
            {"wrong_length", stats.wrong_length}, {"wrong_value", stats.wrong_value}};
}

settings::Json faults_json(const host::LoopStatistics& loop) {
    auto faults = settings::Json::array();
    for (std::uint8_t number = 0; number < control::kFaultCount; ++number) {
        const auto fault = static_cast<control::Fault>(number);
        if (!loop.faults_seen.contains(fault)) continue;
        faults.push_back({{"name", can::name(fault)}, {"first_seen_ns", loop.first_seen[number].count()}});
    }
    return faults;
}

settings::Json states_json(const host::LoopStatistics& loop) {
    auto states = settings::Json::object();
    for (std::uint8_t number = 0; number < control::kStateCount; ++number)
        states[std::string(can::name(static_cast<control::State>(number)))] = loop.steps_in_state[number];
    return states;
}

}  // namespace

std::string json(const RunReport& report) {
    const host::LoopStatistics& loop = report.loop;
    auto durations = settings::Json::object();
    for (const auto& [label, histogram] : histograms(loop)) durations[std::string(label)] = as_json(histogram);
    auto messages = settings::Json::object();
    for (const can::Role role : can::kToController)
        if (report.layout[role].bound) messages[std::string(can::name(role))] = as_json(report.port.stats(role));
    const settings::Json root{{"version", ANTISKID_VERSION},
                              {"config_hash", report.config_hash},
                              {"interface", report.interface},
                              {"clock", report.clock},
                              {"period_ns", report.period.count()},
                              {"steps", loop.steps},
                              {"overruns", loop.overruns},
                              {"missed_periods", loop.missed_periods},
                              {"unsynchronised_steps", loop.unsynchronised},
                              {"steps_by_timer", loop.by_timer},
                              {"records_lost", report.records_lost},
                              {"safe_commands_sent", loop.safe_commands_sent},
                              {"last_state", can::name(loop.last_state)},
                              {"steps_in_state", states_json(loop)},
                              {"faults", faults_json(loop)},
                              {"durations", durations},
                              {"link",
                               {{"outages", loop.link_outages},
                                {"up", report.link.up},
                                {"bus_off_events", report.link.bus_off_events},
                                {"error_frames", report.link.error_frames},
                                {"receive_dropped", report.link.receive_dropped},
                                {"transmit_dropped", report.link.transmit_dropped},
                                {"malformed", report.link.malformed},
                                {"unknown_ids", report.port.unknown_ids()},
                                {"frames_received", loop.frames_received},
                                {"frames_sent", loop.frames_sent},
                                {"frames_unsent", loop.frames_unsent},
                                {"full_drains", loop.full_drains}}},
                              {"messages", messages}};
    return settings::json_page(root);
}

std::string table(const RunReport& report) {
    const host::LoopStatistics& loop = report.loop;
    std::string text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "{} steps of {:.0f} us on {} by {}, last state {}\n", loop.steps, in_us(report.period), report.interface, report.clock,
                   can::name(loop.last_state));
    auto times = settings::TextTable::screen(":<16|count:>10|min:>10.1f|p50:>10.1f|p99:>10.1f|p99.9:>10.1f|max:>10.1f|  us");
    for (const auto& [label, h] : histograms(loop))
        times.add(label, h.count(), in_us(h.minimum()), in_us(h.percentile(0.5)), in_us(h.percentile(0.99)), in_us(h.percentile(0.999)),
                  in_us(h.maximum()), "");
    auto messages = settings::TextTable::screen("message:<18|accepted:>10|rejected:>10|lost:>10");
    for (const can::Role role : can::kToController) {
        if (!report.layout[role].bound) continue;
        const can::MessageStats& stats = report.port.stats(role);
        messages.add(can::name(role), stats.accepted, stats.rejected(), stats.lost);
    }
    text += times.text() + messages.text();
    fmt::format_to(out, "frames: {} received, {} sent, {} unsent, {} dropped by the kernel, {} malformed; link outages: {}\n", loop.frames_received,
                   loop.frames_sent, loop.frames_unsent, report.link.receive_dropped, report.link.malformed, loop.link_outages);
    fmt::format_to(out, "overruns: {} ({} periods missed)\nfaults:", loop.overruns, loop.missed_periods);
    for (const std::string& fault : can::fault_names(loop.faults_seen)) fmt::format_to(out, " {}", fault);
    fmt::format_to(out, "{}\n", loop.faults_seen.empty() ? " none" : "");
    return text;
}

}  // namespace antiskid::controller
