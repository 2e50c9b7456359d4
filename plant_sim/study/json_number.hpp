/// Figures that may be missing, as JSON.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace study {

/// null where it is infinite or no number.
[[nodiscard]] inline nlohmann::ordered_json or_null(double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
}
/// null where it was not measured.
[[nodiscard]] inline nlohmann::ordered_json or_null(const std::optional<double>& value) {
    return value ? or_null(*value) : nlohmann::ordered_json();
}

}  // namespace study
