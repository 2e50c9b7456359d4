/// Everything that is read and checked before the program touches the bus.
#pragma once

#include <string>

#include "firmware/can/layout.hpp"
#include "firmware/control/config.hpp"
#include "firmware/controller/options.hpp"

namespace antiskid::controller {

struct ControllerSetup {
    control::Config control;
    can::Layout layout;
    std::string config_hash;  ///< of configuration, DBC and binding, in this order
    control::Time period{};   ///< control period, whole microseconds
};

/// Throws settings::Error for an error in a file, and for a layout unfit for the chosen clock: lockstep needs a SYNC, and a valve command in every
/// period.
[[nodiscard]] ControllerSetup load_setup(const Options& options);

/// The check of the layout that load_setup() makes.
void check_layout(const can::Layout& layout, ClockSource clock, control::Time period, const std::string& binding);

}  // namespace antiskid::controller
