#include "plant_sim/study/margins/margins_settings.hpp"

#include "config/reader/settings.hpp"

namespace study::margins {

MarginsSettings load_margins_settings(const std::filesystem::path& path) {
    const auto doc = settings::Document::load(path);
    const settings::Table asked = doc.root().table("requirement");
    const settings::Table pid = doc.root().table("pid");
    MarginsSettings s{
        .requirement = {.phase_deg = asked.number("phase_margin_deg", {.min = 0.0, .max = 90.0}),
                        .gain_dB = asked.number("gain_margin_dB", {.min = 0.0, .max = 40.0})},
        .pid = {.k_p_per_s = pid.number("k_p_per_s", {.min = 0.0, .max = 1e4}),
                .k_i_per_s2 = pid.number("k_i_per_s2", {.min = 0.0, .max = 1e5}),
                .k_d = pid.number("k_d", {.min = 0.0, .max = 100.0}),
                .filter_s = 1e-3 * pid.number("filter_ms", {.min = 0.01, .max = 1000.0}),
                .schedule = pid.number("schedule", {.min = 0.0, .max = 2.0})}};
    if (s.pid.k_p_per_s == 0.0 && s.pid.k_i_per_s2 == 0.0)
        pid.fail("k_p_per_s", "is 0 and so is k_i_per_s2: nothing would hold the slip");
    doc.finish();
    return s;
}

}  // namespace study::margins
