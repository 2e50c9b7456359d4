#include "rig_bridge/bridge/rig_hold.hpp"

#include <fmt/core.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <utility>
#include <variant>

#include "rig_bridge/bridge/wall_clock.hpp"

namespace rig::bridge {

namespace {

bool takes_files(const char* directory) {
    return directory != nullptr && *directory != '\0' && access(directory, W_OK | X_OK) == 0;
}

std::string file_name(const modbus::PlcAddress& plc, unsigned unit, std::uint64_t netns) {
    if (const auto* const tcp = std::get_if<modbus::TcpServer>(&plc))
        return fmt::format("antiskid-plc-{}-{}-{}-{}", netns, tcp->address, tcp->port, unit);
    const std::string& path = std::get<modbus::SerialDevice>(plc).path;
    struct stat device {};
    if (stat(path.c_str(), &device) == 0 && S_ISCHR(device.st_mode))
        return fmt::format("antiskid-plc-serial-{}-{}", major(device.st_rdev), minor(device.st_rdev));
    std::string name = path;  // not plugged in: it has its name alone
    std::replace(name.begin(), name.end(), '/', '-');
    return "antiskid-plc-serial" + name;
}

std::string rejection(const std::string& what, const std::string& who) {
    return fmt::format(
        "{} is held by {}. Next: wait until it has ended, or ask it to end (kill -INT and its process "
        "number); one bridge at a time has the rig",
        what, who.empty() ? "another program" : who);
}

}  // namespace

std::filesystem::path lock_directory() {
    constexpr auto kShared = "/run/lock";
    constexpr mode_t kEverybody = 01777;
    // Where a system is booted systemd makes it; a container may have none.
    if (::mkdir(kShared, kEverybody) == 0) static_cast<void>(::chmod(kShared, kEverybody));
    if (takes_files(kShared)) return kShared;
    if (const char* const own = std::getenv("XDG_RUNTIME_DIR"); takes_files(own)) return own;
    throw std::runtime_error(
        "the rig cannot be held against a second bridge: neither /run/lock nor $XDG_RUNTIME_DIR can be "
        "written. Next: mkdir -p -m 1777 /run/lock");
}

std::vector<HoldPlace> hold_places(const std::filesystem::path& directory, const std::string& interface, const modbus::PlcAddress& plc, unsigned unit,
                                   std::uint64_t netns) {
    const bool serial = std::holds_alternative<modbus::SerialDevice>(plc);
    return {{.what = "CAN interface " + interface, .file = directory / fmt::format("antiskid-can-{}-{}", netns, interface)},
            {.what = modbus::to_string(plc) + (serial ? "" : fmt::format(", unit {}", unit)), .file = directory / file_name(plc, unit, netns)}};
}

std::uint64_t network_namespace() {
    struct stat inode {};
    return stat("/proc/self/ns/net", &inode) == 0 ? inode.st_ino : 0;
}

std::vector<HoldPlace> hold_places(const BridgeSetup& setup) {
    return hold_places(lock_directory(), setup.options.interface, modbus::parse_plc_address(setup.options.plc), setup.map.unit_id,
                       network_namespace());
}

std::string holder_text(const std::string& verb, const std::filesystem::path& records) {
    std::error_code none;
    const std::filesystem::path place = std::filesystem::absolute(records, none);
    return fmt::format("rig-bridge {}, process {}, since {}, records in {}", verb, getpid(), iso_8601(std::chrono::system_clock::now()),
                       (none ? records : place).string());
}

RigHold::RigHold(const std::vector<HoldPlace>& places, const std::string& who) {
    for (const HoldPlace& place : places) {
        auto held = settings::PosixStorage{}.hold(place.file, who);
        if (const settings::LockHolder* const other = std::get_if<settings::LockHolder>(&held)) throw RigHeld(rejection(place.what, other->who));
        held_.push_back(std::move(std::get<std::unique_ptr<settings::File>>(held)));
    }
}

std::optional<std::string> rig_held(const std::vector<HoldPlace>& places) {
    for (const HoldPlace& place : places)
        if (const auto other = settings::PosixStorage{}.held_by(place.file)) return rejection(place.what, other->who);
    return std::nullopt;
}

}  // namespace rig::bridge
