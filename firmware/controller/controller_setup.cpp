#include "firmware/controller/controller_setup.hpp"

#include <array>
#include <chrono>
#include <cmath>

#include "firmware/host/controller_config.hpp"
#include "firmware/host/layout_files.hpp"
#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/hash.hpp"

namespace antiskid::controller {

namespace {

std::string milliseconds(const control::Time time) {
    return std::to_string(std::chrono::duration<double, std::milli>(time).count()) + " ms";
}

}  // namespace

void check_layout(const can::Layout& layout, const ClockSource clock, const control::Time period, const std::string& binding) {
    if (clock == ClockSource::timer) return;
    if (!layout[can::Role::sync].bound)
        throw settings::Error(binding, 0, "sync", "no such message, and --clock sync steps on it: bind one, or use --clock timer");
    const control::Time valve = layout[can::Role::valve].period;
    if (valve >= 2 * period)
        throw settings::Error(binding, 0, "valve",
                              "sent every " + milliseconds(valve) + ", but --clock sync answers each SYNC with it, every " + milliseconds(period) +
                                  ": shorten its period, or use --clock timer");
}

ControllerSetup load_setup(const Options& options) {
    const control::Config control = antiskid::load_controller_config(options.controller);
    ControllerSetup setup{.control = control,
                          .layout = options.layout.load(required_range(control)),
                          .config_hash = settings::hash(std::array{options.controller, options.layout.dbc, options.layout.binding}),
                          .period = {}};
    // A float second is not exact: 0.001F is 1000000.05 ns.
    setup.period = std::chrono::microseconds{std::lround(setup.control.period_s * 1e6F)};
    check_layout(setup.layout, options.clock, setup.period, options.layout.binding.string());
    return setup;
}

}  // namespace antiskid::controller
