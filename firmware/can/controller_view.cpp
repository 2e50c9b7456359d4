#include "firmware/can/controller_view.hpp"

namespace antiskid::can {

bool apply(const Layout& layout, Role role, const Payload& payload, control::Time received, ControllerView& view) {
    const auto value = [&payload](const Signal& signal) { return static_cast<float>(signal.value(payload.read(signal))); };
    switch (role) {
        case Role::valve:
            view.command_received = received;
            view.current_mA = value(layout.valve_current_mA);
            return true;
        case Role::status: {
            const std::int64_t state = payload.read(layout.status.state);
            if (state >= control::kStateCount) return false;
            view.status_received = received;
            view.state = static_cast<control::State>(state);
            view.slip = value(layout.status.slip);
            view.slip_reference = value(layout.status.slip_reference);
            view.speed_mps = value(layout.status.speed_mps);
            return true;
        }
        case Role::faults: {
            std::uint32_t bits = 0;
            for (std::size_t i = 0; i < layout.faults.size(); ++i) {
                if (payload.read(layout.faults[i]) != 0) bits |= 1U << i;
            }
            view.faults_received = received;
            view.faults = control::FaultSet::from_bits(bits);
            return true;
        }
        case Role::road:
            view.road_received = received;
            view.road = {.peak_slip = value(layout.road.peak_slip), .grip_N = value(layout.road.grip_N), .confidence = value(layout.road.confidence)};
            return true;
        case Role::controller_heartbeat:
            view.heartbeat_received = received;
            return true;
        default:
            return false;
    }
}

}  // namespace antiskid::can
