/// Figures that may be missing, as JSON.
#pragma once

#include <cmath>
#include <optional>

#include "firmware/host/settings/json.hpp"

namespace study {

/// null where it is infinite or no number.
[[nodiscard]] inline settings::Json or_null(double value) {
    return std::isfinite(value) ? settings::Json(value) : settings::Json();
}
/// null where it was not measured.
[[nodiscard]] inline settings::Json or_null(const std::optional<double>& value) {
    return value ? or_null(*value) : settings::Json();
}

}  // namespace study
