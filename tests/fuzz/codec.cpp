// Frames of any identifier, length and contents, some made good again, into both ends of both layouts; what gets through goes into the
// controller. Whatever comes: no command outside the valve's range, no number that is none, and both readers agree.
#include <array>
#include <cmath>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/e2e.hpp"
#include "firmware/can/load_layout.hpp"
#include "firmware/can/observer.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/control/controller.hpp"
#include "firmware/host/controller_config.hpp"
#include "tests/fuzz/input.hpp"

namespace {

using namespace antiskid;

const can::Layout& layout(bool ours) {
    static const can::Layout own = can::load_layout("config/antiskid.dbc", "config/antiskid_binding.toml");
    static const can::Layout foreign = can::load_layout("config/foreign.dbc", "config/foreign_binding.toml");
    return ours ? own : foreign;
}

const control::Config& config() {
    static const control::Config shipped = load_controller_config("config/controller.toml");
    return shipped;
}

/// Counter and CRC as the true sender would have them, so that contents are judged and not only protection.
void mend(const can::Layout& layout, std::array<std::uint16_t, can::kRoleCount>& counters, can::Frame& frame) {
    for (std::size_t i = 0; i < can::kRoleCount; ++i) {
        const can::Message& message = layout.messages[i];
        if (!message.bound || message.id != frame.id) continue;
        frame.length = message.length;
        const can::E2e& e2e = message.protection;
        if (e2e.protection == can::Protection::none) return;
        can::Signal whole = e2e.counter;
        can::Payload mask;
        mask.write(whole, -1);
        can::Payload counter;
        counter.write(whole, counters[i]);
        counters[i] = static_cast<std::uint16_t>((counters[i] + 1U) % e2e.counter_modulo);
        for (std::size_t k = 0; k < frame.data.size(); ++k)
            frame.data[k] = static_cast<std::uint8_t>((frame.data[k] & ~mask.bytes()[k]) | counter.bytes()[k]);
        if (e2e.protection == can::Protection::counter_crc) frame.data[e2e.crc_byte] = can::e2e_crc(frame, e2e);
        return;
    }
}

void check(const control::Command& command) {
    const control::ValveConfig& valve = config().valve;
    fuzz::require(command.current_mA >= valve.safe_current_mA);
    fuzz::require(command.current_mA <= valve.current_mA[valve.points - 1U]);
    fuzz::require(std::isfinite(command.slip) && std::isfinite(command.speed_mps) && std::isfinite(command.wheel_speed_radps) &&
                  std::isfinite(command.slip_reference) && std::isfinite(command.pressure_request_Pa));
    const bool brakes = command.state == control::State::braking || command.state == control::State::drop_out;
    fuzz::require(brakes || command.current_mA == valve.safe_current_mA);
}

/// What is sent has its message's length.
bool has_its_length(const can::Layout& layout, const can::Frame& frame) {
    for (const can::Message& message : layout.messages) {
        if (message.bound && message.id == frame.id) return message.length == frame.length;
    }
    return false;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Input input(data, size);
    const can::Layout& chosen = layout((input.take<std::uint8_t>() & 1U) != 0);
    constexpr control::Time kStep{1'000'000};
    can::ControllerPort port(chosen, kStep);
    can::RigPort rig(chosen, kStep);
    can::Observer observer(chosen);
    control::Controller controller(config());
    std::array<std::uint16_t, can::kRoleCount> counters{};
    control::Time now{};
    while (!input.empty()) {
        const auto how = input.take<std::uint8_t>();
        can::Frame frame;
        frame.id = input.take<std::uint16_t>();
        if ((how & 1U) != 0) frame.id = chosen.messages[frame.id % can::kRoleCount].id;
        frame.length = how >> 4U;
        frame.data = input.take<std::array<std::uint8_t, 8>>();
        frame.received = now;
        if ((how & 2U) != 0) mend(chosen, counters, frame);
        port.accept(frame);
        rig.accept(frame);
        observer.accept(frame);
        fuzz::require(observer.view().controller.current_mA == rig.controller().current_mA);
        fuzz::require(observer.view().controller.faults == rig.controller().faults);
        if ((how & 4U) == 0) continue;
        now += kStep;
        const control::Command command = controller.step(port.sensors(), now);
        port.clear_one_shots();
        check(command);
        std::array<can::Frame, can::ControllerPort::kMaxFrames> frames;
        const std::size_t count = port.due_frames(command, frames);
        for (std::size_t i = 0; i < count; ++i) fuzz::require(has_its_length(chosen, frames[i]));
    }
    return 0;
}
