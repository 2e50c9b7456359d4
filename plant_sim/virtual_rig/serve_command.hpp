/// `virtual-rig serve`: the rig on CAN and Modbus, for controller and bridge, until it is stopped. See --help.
#pragma once

namespace plant_sim {

/// `argv[0]` is `serve`. Returns the exit status. Throws any exception of the running system.
int serve_command(int argc, char** argv);

}  // namespace plant_sim
