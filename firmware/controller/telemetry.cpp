#include "firmware/controller/telemetry.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "firmware/can/names.hpp"
#include "firmware/host/seconds.hpp"

namespace antiskid::controller {

namespace {

using host::seconds;

constexpr std::uint64_t kMaxLogged = 3;

control::FaultSet without(const control::FaultSet set, const control::FaultSet taken_out) {
    return control::FaultSet::from_bits(set.bits() & ~taken_out.bits());
}

}  // namespace

Telemetry::Telemetry(spdlog::logger& logger, std::string interface) : logger_(logger), interface_(std::move(interface)) {}

void Telemetry::drain(host::CycleRing& ring) {
    for (host::CycleRecord record; ring.pop(record);) on_record(record);
}

void Telemetry::on_record(const host::CycleRecord& record) {
    if ((last_.step == 0 || record.command.state != last_.command.state) && !suppressed(std::string(can::name(record.command.state))))
        logger_.info("[{:.3f} s] state {}", seconds(record.now), can::name(record.command.state));
    report_faults(record);
    report_link(record);
    if (record.synchronised != last_.synchronised && !suppressed("SYNC")) {
        if (record.synchronised)
            logger_.info("[{:.3f} s] SYNC is back on {}", seconds(record.now), interface_);
        else
            logger_.error("[{:.3f} s] no SYNC on {}: the rig is silent; going on by the timer", seconds(record.now), interface_);
    }
    ++steps_;
    missed_ += record.skipped;
    worst_latency_ = std::max(worst_latency_, record.latency);
    last_ = record;
}

void Telemetry::report_faults(const host::CycleRecord& record) {
    if (record.command.faults == last_.command.faults) return;
    for (const std::string& fault : can::fault_names(without(record.command.faults, last_.command.faults))) {
        if (suppressed(fault)) continue;
        logger_.error("[{:.3f} s] fault {}: valve to its safe current", seconds(record.now), fault);
    }
    for (const std::string& fault : can::fault_names(without(last_.command.faults, record.command.faults))) {
        if (suppressed(fault)) continue;
        logger_.info("[{:.3f} s] fault {} cleared", seconds(record.now), fault);
    }
}

bool Telemetry::suppressed(const std::string& what) {
    const bool suppress = ++changes_[what] > kMaxLogged || flaps_.contains(what);
    if (suppress) ++suppressed_count_;
    return suppress;
}

void Telemetry::report_link(const host::CycleRecord& record) {
    const can::LinkStatus& link = record.link;
    if (link.up == last_.link.up && link.bus_off == last_.link.bus_off) return;
    if (suppressed("link")) return;
    const double at = seconds(record.now);
    if (link.bus_off)
        logger_.error("[{:.3f} s] {} is bus-off; the kernel restarts it if it has `ip link set {} type can restart-ms 100`", at, interface_,
                      interface_);
    else if (!link.up)
        logger_.error("[{:.3f} s] {} is down or gone; trying again until it is back", at, interface_);
    else
        logger_.info("[{:.3f} s] {} is up again", at, interface_);
}

void Telemetry::summarise(const host::CycleRing& ring) {
    if (suppressed_count_ != 0) {
        std::string list;
        for (const auto& [what, times] : changes_)
            if (times > 1) list += fmt::format("{}{} {}", list.empty() ? "" : ", ", what, times);
        logger_.warn("{} changes are not listed; since the last summary: {}", suppressed_count_, list);
        suppressed_count_ = 0;
    }
    flaps_.clear();
    for (const auto& [what, times] : changes_)
        if (times > kMaxLogged) flaps_.insert(what);
    changes_.clear();
    if (steps_ == 0) {
        logger_.warn("no step in the last second: {}", last_.step == 0 ? "nothing has come on " + interface_ + " yet" : "the loop stands");
        return;
    }
    const control::Command& c = last_.command;
    logger_.info("[{:.3f} s] {}: v {:.1f} m/s, slip {:.3f} of {:.3f}, request {:.2f} MPa, valve {:.2f} mA; {} steps, {} missed, worst latency {} us",
                 seconds(last_.now), can::name(c.state), c.speed_mps, c.slip, c.slip_reference, c.pressure_request_Pa * 1e-6F, c.current_mA, steps_,
                 missed_, worst_latency_.count() / 1000);
    if (const std::uint64_t dropped = ring.dropped(); dropped != dropped_) {
        logger_.warn("{} records were lost on the way to this log", dropped - dropped_);
        dropped_ = dropped;
    }
    steps_ = 0;
    missed_ = 0;
    worst_latency_ = {};
}

}  // namespace antiskid::controller
