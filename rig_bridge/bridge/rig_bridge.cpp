/// rig-bridge: runs maneuvers and campaigns on a brake rig. See --help.

#include <cstdio>
#include <exception>
#include <stdexcept>
#include <variant>

#include "firmware/host/settings/error.hpp"
#include "rig_bridge/bridge/verbs.hpp"

namespace {

int run(const rig::ManeuverCommand& command) {
    return rig::run_maneuver(command);
}

int run(const rig::CampaignCommand& command) {
    return rig::run_campaign(command);
}

int run(const rig::StatusCommand& command) {
    return rig::show_status(command);
}

int run(const rig::AmendCommand& command) {
    return rig::amend_ledger(command);
}

int run(const rig::NoteCommand& command) {
    return rig::note_in_ledger(command);
}

int run(const rig::HoldCommand& command) {
    return rig::change_hold(command);
}

int run(const rig::WatchCommand& command) {
    return rig::watch_rig(command);
}

int run(const rig::PreflightCommand& command) {
    return rig::run_preflight(command);
}

int fail(int status, const std::exception& e) {
    (void)std::fprintf(stderr, "rig-bridge: %s\n", e.what());
    return status;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const auto parsed = rig::parse_bridge_command(argc, argv);
        if (const int* const status = std::get_if<int>(&parsed)) return *status;
        return std::visit([](const auto& command) { return run(command); }, std::get<rig::BridgeCommand>(parsed));
    } catch (const settings::Error& e) {
        return fail(2, e);
    } catch (const std::invalid_argument& e) {
        return fail(2, e);
    } catch (const rig::UsageError& e) {
        return fail(2, e);
    } catch (const std::exception& e) {
        return fail(1, e);
    }
}
