/// The two files of the bus layout, as every program takes them.
#pragma once

#include <filesystem>

#include "firmware/can/load_layout.hpp"

namespace antiskid {

struct LayoutFiles {
    std::filesystem::path dbc, binding;

    /// `given_dbc`, `given_binding`: the user's; empty: antiskid.dbc and antiskid_binding.toml of `config`.
    explicit LayoutFiles(const std::filesystem::path& config, const std::filesystem::path& given_dbc = {},
                         const std::filesystem::path& given_binding = {})
        : dbc(given_dbc.empty() ? config / "antiskid.dbc" : given_dbc),
          binding(given_binding.empty() ? config / "antiskid_binding.toml" : given_binding) {}

    /// Throws as can::load_layout.
    [[nodiscard]] can::Layout load(const can::RequiredRange& required = {}) const { return can::load_layout(dbc, binding, required); }
};

}  // namespace antiskid
