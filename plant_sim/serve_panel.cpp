#include "plant_sim/serve_panel.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <nlohmann/json.hpp>

#include "rig_bridge/rig/quantities.hpp"

namespace plant_sim {

namespace {

using nlohmann::ordered_json;
using rig::panel::LiveSample;
using rig::panel::Signal;

LiveSample sample_of(const plc::ServedRig& served, const ServeState& state) {
    const plant::Rig& plant = served.rig();
    const plant::Forces forces = plant.forces();
    LiveSample sample;
    sample.time_s = served.time_s();
    sample[Signal::rim] = plant.wheel().v_mps;
    sample[Signal::wheel] = plant.wheel().omega_radps * forces.radius_m;
    if (served.wheel_on_rim()) sample[Signal::slip] = forces.slip;
    if (state.controller_heard) sample[Signal::slip_reference] = static_cast<double>(state.slip_reference.load());
    sample[Signal::pressure] = plant.pressure_Pa();
    sample[Signal::current] = static_cast<double>(state.current_mA.load());
    sample[Signal::load] = forces.F_z_N;
    sample[Signal::temperature] = served.brake_temperature_C();
    return sample;
}

std::string state_of(const plc::ServedRig& served, const ServeState& state) {
    const plc::Trip trip = state.trip;
    const ordered_json facts{{"rig time", fmt::format("{:.1f} s", served.time_s())},
                             {"PLC", trip == plc::Trip::none ? "ready" : "tripped"},
                             {"controller", state.controller_heard ? "heard" : "silent"},
                             {"wheel", served.wheel_on_rim() ? "on the rim" : "off the rim"},
                             {"touchdowns", fmt::format("{}", served.maneuvers())},
                             {"brake has taken", fmt::format("{:.3f} MJ", served.cumulative_energy_J() * 1e-6)},
                             {"mean friction", fmt::format("{:.4f}", served.mean_friction())},
                             {"periods late", fmt::format("{}", state.overruns.load())}};
    const auto bits = static_cast<unsigned>(rig::at(served.measured(), rig::Measured::interlocks));
    ordered_json interlocks = ordered_json::object();
    for (std::size_t i = 0; i < rig::kInterlockCount; ++i) interlocks[std::string(name(static_cast<rig::Interlock>(i)))] = (bits >> i & 1U) != 0;
    ordered_json alarms = ordered_json::array();
    if (trip != plc::Trip::none)
        alarms.push_back({{"name", fmt::format("PLC tripped: {}", plc::name(trip))},
                          {"happened", "the drive is off, the sledge goes back"},
                          {"next", "the bridge resets it once every interlock is good"}});
    return ordered_json{{"facts", facts}, {"interlocks", interlocks}, {"alarms", alarms}}.dump();
}

}  // namespace

ServePanel::ServePanel(const std::string& address, const std::string& scenario)
    : server_({.address = rig::panel::parse_address(address),
               .about = {.title = "virtual-rig: " + scenario, .simulated = true, .rooms = {"live"}},
               .reads = {},
               .changes = {}},
              &feed_) {}

void ServePanel::show(const plc::ServedRig& rig, const ServeState& state) {
    feed_.sample(sample_of(rig, state));
    if (feed_.state_due(rig.time_s())) feed_.state(state_of(rig, state), rig.time_s());
}

}  // namespace plant_sim
