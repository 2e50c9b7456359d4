/// One bridge at a time has a rig: its CAN interface and its PLC, whichever ledger or folder it writes. A second one is refused before it
/// has written a register or sent a frame.
///
///     const RigHold hold(hold_places(setup), holder_text("maneuver", folder));
///
/// The kernel lets go when the program dies, however it dies. What holds only among programs of this computer: a bridge on another one is
/// heard on the bus (start_checks.hpp).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/host/settings/storage.hpp"
#include "rig_bridge/bridge/bridge_setup.hpp"
#include "rig_bridge/modbus/plc_address.hpp"

namespace rig::bridge {

/// What is held, for people, and the file that says so.
struct HoldPlace {
    std::string what;  ///< "CAN interface can0", "Modbus TCP 192.168.1.10:502, unit 1"
    std::filesystem::path file;
};

/// /run/lock, or $XDG_RUNTIME_DIR where that cannot be written: then other users are not kept out. Throws std::runtime_error that says what
/// to do where there is neither.
[[nodiscard]] std::filesystem::path lock_directory();

/// CAN interface, then PLC. Both are names within a network namespace: the same name in another one (`netns`: inode of its /proc/PID/ns/net)
/// is another rig. A serial line is what its device is, by whatever name: two units on one line are two masters there.
[[nodiscard]] std::vector<HoldPlace> hold_places(const std::filesystem::path& directory, const std::string& interface, const modbus::PlcAddress& plc,
                                                 unsigned unit, std::uint64_t netns);
/// This process's network namespace; 0 where /proc does not say.
[[nodiscard]] std::uint64_t network_namespace();

/// Of a bridge that is set up so, in this namespace, locked in lock_directory().
[[nodiscard]] std::vector<HoldPlace> hold_places(const BridgeSetup& setup);

/// "rig-bridge campaign, process 4711, since 2026-11-25T00:16:00Z, records in /srv/runs/brake7".
[[nodiscard]] std::string holder_text(const std::string& verb, const std::filesystem::path& records);

class RigHold {
  public:
    /// Throws RigHeld naming what is held and by whom, std::system_error for a file that cannot be opened.
    RigHold(const std::vector<HoldPlace>& places, const std::string& who);

  private:
    std::vector<std::unique_ptr<settings::File>> held_;
};

/// Somebody else has the rig.
class RigHeld : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Who has any of them, as RigHeld would say it; none: they are free.
[[nodiscard]] std::optional<std::string> rig_held(const std::vector<HoldPlace>& places);

}  // namespace rig::bridge
