#include "rig_bridge/bridge/listen_to_bus.hpp"

#include <array>
#include <span>
#include <stdexcept>

#include "firmware/can/roles.hpp"
#include "firmware/can/socket_can.hpp"
#include "firmware/host/clock.hpp"
#include "rig_bridge/bridge/senders.hpp"

namespace rig::bridge {

using antiskid::can::Role;

BusReception listen_to_bus(const BridgeSetup& setup, antiskid::can::Time length) {
    constexpr antiskid::can::Time kTurn{20'000'000};
    BusReception reception;
    antiskid::can::Observer observer(setup.layout);
    WhoSends senders(setup.layout);
    try {
        const auto ids = antiskid::can::ids(setup.layout, antiskid::can::kEveryRole);
        antiskid::can::SocketCan bus(setup.options.interface, ids.span());
        antiskid::host::MonotonicClock clock;
        const antiskid::can::Time end = clock.now() + length;
        std::array<antiskid::can::Frame, antiskid::can::SocketCan::kBatch> frames;
        for (reception.until = clock.now(); reception.until < end; reception.until = clock.now()) {
            (void)bus.wait(kTurn);
            for (std::size_t count = bus.receive(frames); count > 0; count = bus.receive(frames))
                for (const antiskid::can::Frame& frame : std::span(frames).first(count)) {
                    (void)observer.accept(frame);
                    senders.accept(frame);
                }
        }
    } catch (const std::runtime_error& error) {
        reception.rejection = error.what();
    }
    reception.view = observer.view();
    reception.two_controllers = senders.two_controllers();
    for (const Role role : antiskid::can::kEveryRole) reception.stats[static_cast<std::size_t>(role)] = observer.stats(role);
    return reception;
}

}  // namespace rig::bridge
