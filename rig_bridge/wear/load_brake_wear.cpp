#include "rig_bridge/wear/load_brake_wear.hpp"

#include <system_error>

#include "rig_bridge/wear/model_io.hpp"

namespace wear {

BrakeWear load_brake_wear(const settings::Table& t, const std::filesystem::path& directory) {
    const std::filesystem::path file = directory / t.text("model");
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored))
        t.fail("model", file.string() + " is no file; expected a wear model as `rig-lab wear fit` leaves one");
    return {
        .model = std::make_shared<const Model>(read_model(file)),
        .scale = {.energy = t.number("energy_scale", {.min = 1e-3, .max = 1e6}), .friction = t.number("friction_scale", {.min = 0.1, .max = 10.0})},
        .life_J = t.number("life_J", {.min = 1e3, .max = 1e15}),
        .file = file};
}

}  // namespace wear
