/// The command line of rig-bridge.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "firmware/host/settings/config_directory.hpp"
#include "rig_bridge/bridge/campaign_rules.hpp"
#include "rig_bridge/record/specimen.hpp"
#include "rig_bridge/record/wear_reading.hpp"

namespace rig::bridge {

enum class View : std::uint8_t { automatic, live, plain };  ///< automatic: live on a terminal

/// As Terminal takes it.
[[nodiscard]] constexpr std::optional<bool> wanted(View view) {
    return view == View::automatic ? std::nullopt : std::optional(view == View::live);
}

/// What every verb that moves the rig needs.
struct RigOptions {
    std::filesystem::path scenario;
    std::string interface;
    std::string plc;  ///< numeric IP:PORT, or the device of a serial line
    std::filesystem::path out;
    std::uint64_t seed = 1;
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path dbc, binding, registers;  ///< empty: those of `config`
    bool reset = true;                              ///< a tripped PLC is led back while nothing is on and every interlock is good
    bool leave_turning = false;                     ///< after an abort: end although the rim may still turn
    int priority = 50;
    bool lockstep = false;        ///< step by the bus's SYNC, with a virtual rig that waits
    int answer_timeout_ms = 100;  ///< lockstep: with whoever does not answer
    View view = View::automatic;
    record::Specimen specimen;
    std::filesystem::path on_abort;  ///< program to run after an abort; empty: none
    bool quiet = false;              ///< no bell
    std::string panel;               ///< address of the page; empty: none
};

struct ManeuverCommand {
    RigOptions rig;
    std::filesystem::path picture;  ///< empty: none
    bool cool_down = true;          ///< end with a brake that is cold enough for the next
};
struct CampaignCommand {
    RigOptions rig;
    CampaignRules rules;
    std::string name;                  ///< empty: the scenario's
    bool changed = false;              ///< go on although scenario, seed or configuration changed
    bool regulate = false;             ///< the slip reference shares wear between brake and tyre, maneuver by maneuver
    std::filesystem::path regulation;  ///< plan and rules; empty: regulation.toml of the configuration
    std::string surfaces;              ///< that regulation has to reckon with; empty: those of its file
    std::filesystem::path wear_model;  ///< that judges the brake; empty: nobody does
    std::string held_by;               ///< begins held, by this person; empty: goes on at once
};
struct StatusCommand {
    std::filesystem::path directory;
    std::string json;  ///< file, "-" for standard output, or empty
};
/// What a maneuver adds to the cumulative energy, as a person says.
struct AmendCommand {
    std::filesystem::path directory;
    std::string campaign;  ///< empty: the only one
    std::int64_t number = 0;
    std::optional<std::int64_t> attempt;  ///< none: the only one
    double energy_MJ = 0.0;
    std::string who, why;
};
/// What a person says afterwards of a maneuver's specimen, and reads of its wear.
struct NoteCommand {
    std::filesystem::path directory;
    std::string campaign;  ///< empty: the only one
    std::int64_t number = 0;
    std::optional<std::int64_t> attempt;  ///< none: the only one
    std::string who;
    record::Specimen said;
    std::array<std::string, record::kWearReadingFields.size()> worn;  ///< texts of the ledger's notes; empty: not read
};
/// Holds a campaign between two maneuvers, or lets it go on.
struct HoldCommand {
    std::filesystem::path directory;
    bool hold = false;
    std::string who, why;
};
/// Looks on from another terminal.
struct WatchCommand {
    std::filesystem::path directory;  ///< of the campaign; empty: a single maneuver
    std::filesystem::path scenario;   ///< empty: the campaign's
    std::string interface;
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path dbc, binding;  ///< empty: those of `config`
    bool once = false;
    std::string json;  ///< file, "-" for standard output, or empty
};
/// Looks at everything that the maneuvers to come need, and moves nothing.
struct PreflightCommand {
    RigOptions rig;
    int maneuvers = 1;                  ///< that the disk must have room for
    std::uint32_t bitrate = 1'000'000;  ///< of the rig's CAN
    std::string json;                   ///< file, "-" for standard output, or empty
};
using BridgeCommand =
    std::variant<ManeuverCommand, CampaignCommand, StatusCommand, AmendCommand, NoteCommand, HoldCommand, WatchCommand, PreflightCommand>;

/// The command, or the exit status when there is nothing to do. Throws settings::Error or std::invalid_argument.
[[nodiscard]] std::variant<BridgeCommand, int> parse_bridge_command(int argc, const char* const* argv);

/// Of a campaign's directory.
[[nodiscard]] inline std::filesystem::path ledger_file(const std::filesystem::path& directory) {
    return directory / "campaign.sqlite";
}

}  // namespace rig::bridge
