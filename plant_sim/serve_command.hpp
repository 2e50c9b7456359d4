/// `virtual-rig serve`: the rig behind CAN and Modbus, for the controller and the bridge, until it is stopped. See --help.
#pragma once

namespace plant_sim {

/// `argv[0]` is `serve`. Returns the exit status; throws what a running system throws.
int serve_command(int argc, char** argv);

}  // namespace plant_sim
