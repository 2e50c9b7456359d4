#include <fmt/core.h>

#include <chrono>

#include "rig_bridge/bridge/hold.hpp"
#include "rig_bridge/bridge/verbs.hpp"
#include "rig_bridge/bridge/wall_clock.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/record/specimen.hpp"

namespace rig::bridge {

int change_hold(const HoldCommand& command) {
    const std::filesystem::path& place = command.directory;
    if (!std::filesystem::exists(ledger_file(place))) throw UsageError(place.string() + ": no campaign is here: no " + ledger_file({}).string());
    if (!command.hold) {
        fmt::print("{}: {}\n", place.string(), remove_hold(place) ? "goes on" : "was not held");
        return 0;
    }
    record::check_text("--who", command.who);
    record::check_text("--why", command.why);
    const auto before = read_hold(place);
    if (!before) write_hold(place, {.who = command.who, .since = iso_8601(std::chrono::system_clock::now()), .why = command.why});
    fmt::print("{}: {}; {}\n", place.string(), to_text(*read_hold(place)),
               before ? "it was held already" : "a maneuver that runs comes to its end first");
    return 0;
}

}  // namespace rig::bridge
