/// A figure that may be missing, as JSON.
#pragma once

#include <optional>

#include "firmware/host/settings/json.hpp"

namespace study {

/// null if not measured.
[[nodiscard]] inline settings::Json or_null(const std::optional<double>& value) {
    return value ? settings::Json(*value) : settings::Json();
}

}  // namespace study
