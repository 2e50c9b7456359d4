/// Explanations as text and JSON.
#pragma once

#include <span>
#include <string>

#include "plant_sim/study/faults/explain.hpp"

namespace faults {

[[nodiscard]] std::string to_table(const FaultPlan& plan, std::span<const Explanation> explanations);
[[nodiscard]] std::string to_json(const FaultPlan& plan, std::span<const Explanation> explanations);

}  // namespace faults
