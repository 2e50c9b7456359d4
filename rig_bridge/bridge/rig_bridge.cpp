/// rig-bridge: runs maneuvers and campaigns on a brake rig. See --help.

#include <cstdio>
#include <exception>
#include <stdexcept>
#include <variant>

#include "firmware/host/settings/error.hpp"
#include "rig_bridge/bridge/verbs.hpp"

namespace {

int run(const rig::bridge::ManeuverCommand& command) {
    return rig::bridge::run_maneuver(command);
}

int run(const rig::bridge::CampaignCommand& command) {
    return rig::bridge::run_campaign(command);
}

int run(const rig::bridge::StatusCommand& command) {
    return rig::bridge::show_status(command);
}

int run(const rig::bridge::AmendCommand& command) {
    return rig::bridge::amend_ledger(command);
}

int run(const rig::bridge::NoteCommand& command) {
    return rig::bridge::note_in_ledger(command);
}

int run(const rig::bridge::HoldCommand& command) {
    return rig::bridge::change_hold(command);
}

int run(const rig::bridge::WatchCommand& command) {
    return rig::bridge::watch_rig(command);
}

int run(const rig::bridge::PreflightCommand& command) {
    return rig::bridge::run_preflight(command);
}

int fail(int status, const std::exception& e) {
    (void)std::fprintf(stderr, "rig-bridge: %s\n", e.what());
    return status;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const auto parsed = rig::bridge::parse_bridge_command(argc, argv);
        if (const int* const status = std::get_if<int>(&parsed)) return *status;
        return std::visit([](const auto& command) { return run(command); }, std::get<rig::bridge::BridgeCommand>(parsed));
    } catch (const settings::Error& e) {
        return fail(2, e);
    } catch (const std::invalid_argument& e) {
        return fail(2, e);
    } catch (const rig::bridge::UsageError& e) {
        return fail(2, e);
    } catch (const std::exception& e) {
        return fail(1, e);
    }
}
