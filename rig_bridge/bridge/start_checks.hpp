/// What of `rig-bridge preflight` runs at every start of a maneuver or campaign: all that costs no more than a third of a second and says
/// nothing of a rig that is still on its way to rest. docs/user/bridge.md has the list, and why the others are not in it.
#pragma once

#include <stdexcept>
#include <string>

#include "rig_bridge/bridge/preflight.hpp"

namespace rig::bridge {

/// For `length`; sends nothing.
[[nodiscard]] BusReception listen_to_bus(const BridgeSetup& setup, antiskid::can::Time length);

struct StartFacts {
    antiskid::controller::CanLink link;
    antiskid::controller::MachineFacts machine;  ///< of the record's place
    BusReception bus;
};

/// Interface, disk, no second bridge on the bus, no second controller. `record`: where the record goes.
[[nodiscard]] Checks start_checks(const StartFacts& facts, const std::string& interface, const std::filesystem::path& record);

/// The start is refused: each check that failed, with its next step.
class NotFit : public std::runtime_error {
  public:
    explicit NotFit(const Checks& checks);
};

/// Asks this computer, and listens to the bus for a third of a second. Throws NotFit.
void check_start(const BridgeSetup& setup, const std::filesystem::path& record);

}  // namespace rig::bridge
