#include "rig_bridge/rig/load_compliance.hpp"

#include <array>
#include <optional>
#include <string>

namespace rig {

namespace {

using settings::Table;

constexpr settings::Range kDamping{.min = 0.0, .max = 1.0};

}  // namespace

Compliance load_tyre(const Table& root) {
    const std::optional<Table> t = root.find_table("tyre");
    if (!t) return {};
    enum class Model { rigid, ring, relaxation };
    static constexpr std::array<settings::Choice<Model>, 3> kModels{
        {{"static", Model::rigid}, {"ring", Model::ring}, {"relaxation", Model::relaxation}}};
    const Model model = t->choice<Model>("model", kModels);
    Compliance out;
    if (model == Model::ring)
        out.ring = {.belt_share = t->number("belt_share", {.min = 0.01, .max = 0.9}),
                    .frequency_Hz = t->number("frequency_Hz", {.min = 5.0, .max = 1000.0}),
                    .damping = t->number("damping", kDamping)};
    if (model == Model::relaxation)
        out.relaxation = {.length_m = t->number("length_m", {.min = 0.001, .max = 2.0}), .floor_m = t->number("floor_m", {.min = 0.001, .max = 2.0})};
    return out;
}

LegParameters load_leg(const Table& root, double mass_kg) {
    const std::optional<Table> t = root.find_table("leg");
    if (!t) return {};
    const LegParameters out{.mass_kg = t->number("mass_kg", {.min = 1.0, .max = 1000.0}),
                            .frequency_Hz = t->number("frequency_Hz", {.min = 1.0, .max = 100.0}),
                            .damping = t->number("damping", kDamping)};
    if (out.mass_kg >= mass_kg) t->fail("mass_kg", "is all of the " + std::to_string(mass_kg) + " kg on the wheel; expected less");
    return out;
}

}  // namespace rig
