/// The shipped layouts as texts, and what is said of changed ones.
#pragma once

#include <string>

#include "firmware/can/load_layout.hpp"
#include "firmware/host/settings/error.hpp"
#include "tests/can/layouts.hpp"

namespace bindings {

using can_test::contents;

/// The message of the refusal, "" when the layout was accepted.
inline std::string rejection(const std::string& dbc, const std::string& toml) {
    const can_test::TempDir dir;
    const auto dbc_path = dir.write("a.dbc", dbc);
    const auto toml_path = dir.write("a.toml", toml);
    try {
        static_cast<void>(antiskid::can::load_layout(dbc_path, toml_path));
    } catch (const settings::Error& error) {
        return error.what();
    }
    return "";
}

inline const std::string kOurDbc = contents("config/antiskid.dbc");
inline const std::string kOurs = contents("config/antiskid_binding.toml");
inline const std::string kForeignDbc = contents("config/foreign.dbc");
inline const std::string kForeign = contents("config/foreign_binding.toml");

}  // namespace bindings
