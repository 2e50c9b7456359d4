#include "plant_sim/bench/recorded_stop.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <utility>

#include "firmware/can/roles.hpp"
#include "plant_sim/study/in_process.hpp"

namespace antiskid::bench {

namespace {

can_frame raw(const can::Frame& frame) {
    can_frame out{};
    out.can_id = frame.id;
    out.can_dlc = frame.length;
    std::copy(frame.data.begin(), frame.data.end(), std::begin(out.data));
    return out;
}

}  // namespace

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
