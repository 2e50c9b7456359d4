/// Locks a rig, i.e. its CAN interface and its PLC, for one bridge, whatever ledger or folder it writes to. A second bridge is refused before it
/// writes a register or sends a frame.
///
///     const RigHold hold(hold_places(setup), holder_text("maneuver", folder));
///
/// The kernel releases the lock when the program ends, in whatever way. The lock is effective on this computer only: a bridge on another one is
/// detected by its frames (start_checks.hpp).
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

/// A locked resource and its lock file.
struct HoldPlace {
    std::string what;  ///< "CAN interface can0", "Modbus TCP 192.168.1.10:502, unit 1"
    std::filesystem::path file;
};

/// /run/lock, or $XDG_RUNTIME_DIR if that is not writable, which does not lock out other users. Throws std::runtime_error that says what to do if
/// there is neither.
[[nodiscard]] std::filesystem::path lock_directory();

/// CAN interface, then PLC. Both are names within a network namespace: the same name in another one (`netns`: inode of its /proc/PID/ns/net)
/// is another rig. A serial line is identified by its device, whatever the path, and locked for all units: it allows only one master.
[[nodiscard]] std::vector<HoldPlace> hold_places(const std::filesystem::path& directory, const std::string& interface, const modbus::PlcAddress& plc,
                                                 unsigned unit, std::uint64_t netns);
/// This process's network namespace; 0 if /proc does not show it.
[[nodiscard]] std::uint64_t network_namespace();

/// The same for this setup, in this network namespace and lock_directory().
[[nodiscard]] std::vector<HoldPlace> hold_places(const BridgeSetup& setup);

/// "rig-bridge campaign, process 4711, since 2026-11-25T00:16:00Z, records in /srv/runs/brake7".
[[nodiscard]] std::string holder_text(const std::string& verb, const std::filesystem::path& records);

class RigHold {
  public:
    /// Throws RigHeld naming the held resource and its holder, std::system_error for a file that cannot be opened.
    RigHold(const std::vector<HoldPlace>& places, const std::string& who);

  private:
    std::vector<std::unique_ptr<settings::File>> held_;
};

/// Another program holds the rig.
class RigHeld : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Who holds any of `places`, with the text of RigHeld; none: all are free.
[[nodiscard]] std::optional<std::string> rig_held(const std::vector<HoldPlace>& places);

}  // namespace rig::bridge
