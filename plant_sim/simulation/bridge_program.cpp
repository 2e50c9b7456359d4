#include "plant_sim/simulation/bridge_program.hpp"

#include <array>

namespace plant_sim::simulation {

BridgeProgram::BridgeProgram(const rig::bridge::BridgeSetup& setup, antiskid::can::Bus& sends, antiskid::can::Bus& hears,
                             std::unique_ptr<rig::modbus::PlcLine> line, std::function<antiskid::can::Time()> now)
    : hears_(hears),
      now_(std::move(now)),
      listener_(setup.layout, setup.meter),
      plc_(setup.map, std::move(line), now_),
      node_(setup.layout, setup.meter.period_s, setup.limits, plc_, feed_, sends) {}

const rig::bridge::Moment& BridgeProgram::step(rig::Sequencer* sequencer, const rig::bridge::Node::Wishes& wishes) {
    std::array<antiskid::can::Frame, 64> frames{};
    for (std::size_t count = frames.size(); count == frames.size();) {
        count = hears_.receive(frames);
        for (std::size_t i = 0; i < count; ++i) listener_.accept(frames[i]);
    }
    feed_.heard.up = hears_.status().up;
    listener_.tell(feed_.heard, now_(), true);
    return node_.step(sequencer, wishes, now_());
}

}  // namespace plant_sim::simulation
