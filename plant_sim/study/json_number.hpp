/// Figures that may be missing, as JSON.
#pragma once

#include <cmath>
#include <optional>

#include "firmware/host/settings/json.hpp"

namespace study {

/// null if infinite or NaN.
[[nodiscard]] inline settings::Json or_null(double value) {
    return std::isfinite(value) ? settings::Json(value) : settings::Json();
}
/// null if not measured.
[[nodiscard]] inline settings::Json or_null(const std::optional<double>& value) {
    return value ? or_null(*value) : settings::Json();
}

}  // namespace study
