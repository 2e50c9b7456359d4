#include "rig_bridge/bridge/panel_state.hpp"

#include <fmt/core.h>

#include "firmware/can/names.hpp"
#include "firmware/host/settings/json.hpp"
#include "rig_bridge/bridge/next_step.hpp"
#include "rig_bridge/record/summary.hpp"

namespace rig::bridge {

namespace {

using antiskid::control::Fault;
using antiskid::control::kFaultCount;
using panel::Signal;
using settings::Json;

Json alarm(std::string_view name, std::string_view happened, std::string_view next) {
    return {{"name", name}, {"happened", happened}, {"next", next}};
}

Json alarms(const ViewModel& v, const Moment& m) {
    Json all = Json::array();
    if (v.record_lost) {
        all.push_back(alarm(record::kRecordLost, v.note, "make room, or give another disk; start again"));
    } else if (v.abort != Abort::none) {
        const NextStep step = next_step(v.abort);
        all.push_back(alarm(fmt::format("abort: {}", name(v.abort)), step.happened, step.next));
    }
    if (m.inputs.controller_fresh)
        for (std::size_t i = 0; i < kFaultCount; ++i) {
            const auto fault = static_cast<Fault>(i);
            if (!m.bus.view.controller.faults.contains(fault)) continue;
            all.push_back(alarm(fmt::format("fault: {}", antiskid::can::kFaultNames[i]), next_step(fault).happened, next_step(fault).next));
        }
    return all;
}

}  // namespace

panel::LiveSample live_sample(const Moment& m) {
    panel::LiveSample sample;
    sample.time_s = m.rig_s;
    if (m.inputs.bus_up && m.inputs.sensors_fresh) {
        sample[Signal::rim] = m.inputs.rim_mps;
        sample[Signal::wheel] = m.inputs.wheel_rim_mps;
        sample[Signal::pressure] = m.inputs.pressure_Pa;
        if (m.inputs.wheel_on_rim) sample[Signal::slip] = m.bus.slip;
    }
    if (m.inputs.controller_fresh) {
        sample[Signal::slip_reference] = static_cast<double>(m.bus.view.controller.slip_reference);
        sample[Signal::current] = static_cast<double>(m.bus.view.controller.current_mA);
    }
    sample[Signal::demand] = m.outputs.demand_Pa;
    if (m.inputs.plc_fresh) {
        sample[Signal::load] = m.inputs.load_N;
        sample[Signal::temperature] = m.inputs.brake_temperature_C;
    }
    return sample;
}

std::string panel_state(const ViewModel& v, const Moment& m, std::optional<HoldStatus> campaign) {
    Json facts = Json::object();
    const auto fact = [&facts](const char* label, std::string_view text) {
        if (!text.empty()) facts[label] = text;
    };
    fact("scenario", v.scenario);
    fact("phase", fmt::format("{}, {:.1f} s", name(v.phase), v.phase_s));
    fact("controller", v.controller);
    fact("PLC", v.plc);
    fact("bus", v.bus);
    if (v.campaign) {
        fact("campaign", fmt::format("maneuver {}, {} of {} finished", v.campaign->number, v.campaign->finished, v.campaign->planned));
        fact("time left", v.campaign->left_s ? duration_text(*v.campaign->left_s) : "unknown");
        fact("brake's health", v.campaign->health);
        fact("landings left", v.campaign->landings_left);
        fact("regulation", v.campaign->regulation);
    }
    fact("frames", fmt::format("{}, {} dropped", v.frames, v.dropped));
    fact("note", v.note);
    Json interlocks = Json::object();
    if (m.inputs.plc_fresh)
        interlocks = {{"emergency stop released", m.inputs.emergency_stop_clear},
                      {"guard closed", m.inputs.guard_closed},
                      {"hydraulics ready", m.inputs.hydraulics_ready},
                      {"drive healthy", m.inputs.drive_healthy}};
    const Json status = campaign ? Json(name(*campaign)) : Json(nullptr);
    return Json{{"facts", facts}, {"interlocks", interlocks}, {"alarms", alarms(v, m)}, {"campaign", status}}.dump(-1, ' ', false,
                                                                                                                   Json::error_handler_t::replace);
}

}  // namespace rig::bridge
