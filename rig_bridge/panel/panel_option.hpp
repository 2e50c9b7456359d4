/// Adds the option `--panel [ADDRESS:PORT]` to a program.
#pragma once

#include <CLI/CLI.hpp>

#include <string>

#include "rig_bridge/panel/server.hpp"

namespace rig::panel {

/// `address` stays empty without the option. An invalid address throws std::invalid_argument while the command line is read.
inline CLI::Option* add_panel_option(CLI::App& app, std::string& address) {
    return app
        .add_option_function<std::string>(
            "--panel",
            [&address](const std::string& given) {
                address = given.empty() ? kDefaultAddress : given;
                (void)parse_address(address);
            },
            std::string("a page in the browser that shows all of it live; without a value ") + kDefaultAddress + "; port 0: any free one")
        ->expected(0, 1)
        ->type_name("ADDRESS:PORT");
}

}  // namespace rig::panel
