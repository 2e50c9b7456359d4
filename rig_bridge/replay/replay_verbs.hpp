/// The verbs of rig-replay: each adds itself to the command line and returns the function that runs it.
#pragma once

#include <functional>
#include <string>

#include "firmware/host/settings/command_line.hpp"
#include "rig_bridge/replay/log_warnings.hpp"

namespace rig::replay {

struct ReplayVerb {
    CLI::App* app;
    std::function<int()> run;  ///< returns the exit status
};

/// An error in command line or configuration found after parsing: exit status 2.
struct UsageError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

[[nodiscard]] ReplayVerb bus_verb(CLI::App& app);
[[nodiscard]] ReplayVerb campaign_verb(CLI::App& app);
[[nodiscard]] ReplayVerb controller_verb(CLI::App& app);
[[nodiscard]] ReplayVerb export_verb(CLI::App& app);
[[nodiscard]] ReplayVerb import_verb(CLI::App& app);

/// Runs `load` and converts its exceptions to UsageError.
template <typename Load>
auto configured(Load load) {
    try {
        return load();
    } catch (const std::exception& error) {
        throw UsageError(error.what());
    }
}

/// Log warnings of `file`, reported on standard error.
[[nodiscard]] LogWarnings warnings_of(const std::string& file);

}  // namespace rig::replay
