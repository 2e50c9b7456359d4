#include "rig_bridge/wear/load_brake_wear.hpp"

#include <system_error>

#include "rig_bridge/wear/model_io.hpp"

namespace wear {

namespace {

LiningLaw lining_law(const settings::Table& t) {
    constexpr settings::Range kShare{.min = 0.0, .max = 1.0}, kEnergy_J{.min = 1e3, .max = 1e15};
    return {.plateau = t.number("plateau", {.min = 0.02, .max = 1.0}),
            .run_in = t.number("run_in", kShare),
            .run_in_J = t.number("run_in_J", kEnergy_J),
            .loss = t.number("loss", kShare),
            .lining_J = t.number("lining_J", kEnergy_J),
            .core_loss = t.number("core_loss", kShare),
            .core_share = t.number("core_share", {.min = 0.001, .max = 1.0}),
            .per_temperature = t.number("per_temperature", {.min = -0.1, .max = 0.1}),
            .memory = t.number("memory", {.min = 0.0, .max = 0.75}),
            .play = t.number("play", {.min = 0.0, .max = 3.0}),
            .measurement = t.number("measurement", {.min = 0.0, .max = 0.1})};
}

}  // namespace

BrakeWear load_brake_wear(const settings::Table& t, const std::filesystem::path& directory) {
    const std::filesystem::path file = directory / t.text("model");
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored))
        t.fail("model", file.string() + " is no file; expected a wear model as `rig-lab wear fit` leaves one");
    return {
        .model = std::make_shared<const Model>(read_model(file)),
        .scale = {.energy = t.number("energy_scale", {.min = 1e-3, .max = 1e6}), .friction = t.number("friction_scale", {.min = 0.1, .max = 10.0})},
        .life_J = t.number("life_J", {.min = 1e3, .max = 1e15}),
        .file = file,
        .law = t.has("law") ? std::optional(lining_law(t.table("law"))) : std::nullopt};
}

}  // namespace wear
