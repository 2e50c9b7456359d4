/// A maneuver's record in progress: bus.log, and the figures from its frames.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "firmware/can/layout.hpp"
#include "rig_bridge/record/bus_log.hpp"
#include "rig_bridge/record/bus_meter.hpp"
#include "rig_bridge/record/stamp_label.hpp"

namespace rig::bridge {

struct Recording {
    record::BusLog log;
    record::BusMeter meter;
    std::uint64_t dropped_before = 0;  ///< by the kernel, when it began
    std::uint64_t dropped = 0;         ///< by the kernel, during it
    bool interrupted = false;          ///< the interface was gone for a while

    record::StampLabel label;

    /// `wall_minus_monotonic`: clock offset at the beginning of the record.
    Recording(std::unique_ptr<record::LineFile> file, const std::string& interface, const antiskid::can::Layout& layout,
              const record::MeterParameters& parameters, antiskid::can::Time wall_minus_monotonic)
        : log(std::move(file), interface), meter(layout, parameters), label(wall_minus_monotonic) {}

    /// Takes a frame with the kernel's stamp; `came` is its arrival on the monotonic clock.
    void take(record::CapturedFrame& one, antiskid::can::Time came) {
        one.frame.received = label.of(one.frame.received, came);
        log.write(one);
        if (one.plain()) meter.accept(one.frame);
    }
};

}  // namespace rig::bridge
