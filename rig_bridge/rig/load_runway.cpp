#include "rig_bridge/rig/load_runway.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "firmware/host/settings/settings.hpp"

namespace rig {

namespace {

using settings::Table;

const Surface& named(const Table& t, std::string_view key, const std::string& name, const std::vector<Surface>& surfaces) {
    const auto found = std::find_if(surfaces.begin(), surfaces.end(), [&](const Surface& surface) { return surface.name == name; });
    if (found != surfaces.end()) return *found;
    std::string known;
    for (const Surface& surface : surfaces) known += (known.empty() ? "" : ", ") + surface.name;
    t.fail(key, "unknown surface '" + name + "'; there are " + known);
}

Surface wet(const Table& t, const std::vector<Surface>& surfaces) {
    static constexpr std::array<settings::Choice<Texture>, 2> kTextures{{{"smooth", Texture::smooth}, {"grooved", Texture::grooved}}};
    const double psi = t.number("tyre_pressure_psi", {.min = WetGrip::kMinPressure_psi, .max = WetGrip::kMaxPressure_psi});
    const auto texture = t.choice<Texture>("texture", kTextures);
    const bool flooded = t.find_boolean("flooded").value_or(false);
    const auto flooded_mu = t.find_number("flooded_mu", {.min = 0.0, .max = 0.1});
    if (flooded_mu && !flooded) t.fail("flooded_mu", "counts with flooded = true only");
    Surface surface = named(t, "curve", t.find_text("curve").value_or("wet_asphalt"), surfaces);
    const double own_slip = peak(surface).slip;
    const double peak_slip = t.find_number("peak_slip", {.min = 0.02, .max = 0.5}).value_or(own_slip);
    surface.c2 *= own_slip / peak_slip;
    surface.c3 *= own_slip / peak_slip;
    if (surface.magic) surface.magic->B *= own_slip / peak_slip;
    if (!surface.magic && surface.c3 >= surface.c1)
        t.fail("peak_slip", "leaves a locked wheel no friction on the curve of '" + surface.name + "'; expected a later peak");
    // EASA AMC 25.1591: friction to be assumed in standing water above the aquaplaning speed.
    constexpr double kAfloat = 0.05;
    surface.wet.emplace(psi, texture, flooded ? std::optional(flooded_mu.value_or(kAfloat)) : std::nullopt);
    surface.name = fmt::format("{} {} at {:g} psi", flooded ? "flooded" : "wet", texture == Texture::smooth ? "smooth" : "grooved", psi);
    return surface;
}

Surface surface(const Table& t, const std::vector<Surface>& surfaces) {
    const bool dry = t.has("surface"), is_wet = t.has("wet");
    if (dry == is_wet)
        t.fail(dry ? "wet" : "",
               dry ? "stands beside 'surface'; expected one of them" : "expected surface = \"NAME\" or wet = { tyre_pressure_psi, texture }");
    return dry ? named(t, "surface", t.text("surface"), surfaces) : wet(t.table("wet"), surfaces);
}

}  // namespace

Runway load_runway(const std::filesystem::path& file, const std::vector<Surface>& surfaces) {
    const settings::Document doc = settings::Document::load(file);
    Runway runway{.patches = {}, .from_touchdown = true};
    for (const Table& t : doc.root().tables("patch")) {
        const double from_m = t.number("from_m", {.min = 0.0, .max = 20000.0});
        if (runway.patches.empty() && from_m > 0.0) t.fail("from_m", "leaves nothing to land on; the first patch begins at 0");
        if (!runway.patches.empty() && from_m <= runway.patches.back().from_m)
            t.fail("from_m", fmt::format("must lie behind the patch before it, at {:g} m", runway.patches.back().from_m));
        runway.patches.push_back({from_m, surface(t, surfaces)});
    }
    doc.finish();
    return runway;
}

}  // namespace rig
