#include "plant_sim/virtual_rig/serve_panel.hpp"

#include <fmt/core.h>

#include <cstddef>

#include "firmware/host/settings/json.hpp"
#include "rig_bridge/rig/quantities.hpp"

namespace plant_sim {

namespace {

using rig::panel::LiveSample;
using rig::panel::Signal;
using settings::Json;

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

std::string text_of(const ServePanel::Facts& f) {
    const Json facts{{"rig time", fmt::format("{:.1f} s", f.time_s)},           {"PLC", f.trip == plc::Trip::none ? "ready" : "tripped"},
                     {"controller", f.controller_heard ? "heard" : "silent"},   {"wheel", f.wheel_on_rim ? "on the rim" : "off the rim"},
                     {"touchdowns", fmt::format("{}", f.touchdowns)},           {"brake has taken", fmt::format("{:.3f} MJ", f.energy_J * 1e-6)},
                     {"mean friction", fmt::format("{:.4f}", f.mean_friction)}, {"periods late", fmt::format("{}", f.late)}};
    Json interlocks = Json::object();
    for (std::size_t i = 0; i < rig::kInterlockCount; ++i)
        interlocks[std::string(name(static_cast<rig::Interlock>(i)))] = (f.interlocks >> i & 1U) != 0;
    Json alarms = Json::array();
    if (f.trip != plc::Trip::none)
        alarms.push_back({{"name", fmt::format("PLC tripped: {}", plc::name(f.trip))},
                          {"happened", "the drive is off, the sledge goes back"},
                          {"next", "the bridge resets it once every interlock is good"}});
    return Json{{"facts", facts}, {"interlocks", interlocks}, {"alarms", alarms}}.dump();
}

}  // namespace

ServePanel::ServePanel(const std::string& address, const std::string& scenario)
    : feed_([this] { return states(); }),
      server_({.address = rig::panel::parse_address(address),
               .about = {.title = "virtual-rig: " + scenario, .simulated = true, .views = {"live"}},
               .reads = {},
               .changes = {}},
              &feed_) {}

void ServePanel::show(const plc::ServedRig& rig, const ServeState& state) {
    constexpr double kEvery_s = 0.1;
    feed_.sample(sample_of(rig, state));
    if (rig.time_s() < next_s_) return;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return;
    next_s_ = rig.time_s() + kEvery_s;
    facts_ = {.time_s = rig.time_s(),
              .trip = state.trip,
              .controller_heard = state.controller_heard,
              .wheel_on_rim = rig.wheel_on_rim(),
              .touchdowns = rig.maneuvers(),
              .energy_J = rig.cumulative_energy_J(),
              .mean_friction = rig.mean_friction(),
              .late = state.overruns,
              .interlocks = static_cast<unsigned>(rig::at(rig.measured(), rig::Measured::interlocks))};
}

std::optional<std::string> ServePanel::states() {
    std::optional<Facts> facts;
    {
        const std::lock_guard lock(mutex_);
        facts.swap(facts_);
    }
    if (!facts) return std::nullopt;
    return text_of(*facts);
}

}  // namespace plant_sim
