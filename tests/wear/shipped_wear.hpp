#pragma once

#include <memory>

#include "rig_bridge/wear/model_io.hpp"
#include "rig_bridge/wear/population_io.hpp"
#include "rig_bridge/wear/wearing_brake.hpp"

/// A brake of the shipped model, with the life of its campaign.
inline wear::BrakeWear shipped_wear(const wear::BrakeScale& scale = {}) {
    return {std::make_shared<const wear::Model>(wear::read_model("config/wear/model.json")), scale, 488e6, "config/wear/model.json"};
}

[[nodiscard]] inline const wear::Population& shipped_population() {
    static const wear::Population p = wear::read_population("config/wear/population.json").population;
    return p;
}
