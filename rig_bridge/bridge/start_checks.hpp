/// The checks of `rig-bridge preflight` that run at every start of a maneuver or campaign: those that take at most a third of a second and do not
/// need a rig at rest. docs/user/bridge.md lists them and says why the others are not included.
#pragma once

#include <stdexcept>
#include <string>

#include "firmware/can/bus.hpp"
#include "firmware/host/clock.hpp"
#include "rig_bridge/bridge/preflight.hpp"

namespace rig::bridge {

/// Listens for `length`, also where frames come as fast as they are read; sends nothing.
[[nodiscard]] BusReception listen_to_bus(const antiskid::can::Layout& layout, antiskid::can::Bus& bus, antiskid::host::Clock& clock,
                                         antiskid::can::Time length);
/// The same on the interface of `setup`.
[[nodiscard]] BusReception listen_to_bus(const BridgeSetup& setup, antiskid::can::Time length);

struct StartFacts {
    antiskid::controller::CanLink link;
    antiskid::controller::MachineFacts machine;  ///< of the directory of the record
    BusReception bus;
};

/// Checks interface, disk, and that no second bridge or controller is on the bus. `record`: directory of the record.
[[nodiscard]] Checks start_checks(const StartFacts& facts, const std::string& interface, const std::filesystem::path& record);

/// The start is refused; the text lists each failed check and what to do.
class NotFit : public std::runtime_error {
  public:
    explicit NotFit(const Checks& checks);
};

/// Checks this computer and listens to the bus for a third of a second. Throws NotFit.
void check_start(const BridgeSetup& setup, const std::filesystem::path& record);

}  // namespace rig::bridge
