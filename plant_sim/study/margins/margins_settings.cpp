#include "plant_sim/study/margins/margins_settings.hpp"

#include <algorithm>
#include <string_view>

#include "firmware/host/settings/settings.hpp"

#include "plant_sim/study/margins/law_judge.hpp"

namespace study::margins {

namespace {

constexpr int kDigits = 3;  // of a shipped gain

LawSearch law_search(const settings::Table& t) {
    const settings::Table stops = t.table("stops"), draws = t.table("draws"), gains = t.table("gains");
    LawSearch s{.options = {.seed = t.integer<std::uint64_t>("seed", {.min = 0}),
                            .population = t.integer<int>("population", {.min = 4, .max = 1000}),
                            .generations = t.integer<int>("generations", {.min = 0, .max = 10000}),
                            .digits = kDigits},
                .min_gain = t.number("min_gain", {.min = 1e-6, .max = 1.0}),
                .stops = {.mean_j_mu = stops.number("mean_j_mu", {.min = 0.0, .max = 1.0}),
                          .longest_lock_s = 1e-3 * stops.number("longest_lock_ms", {.min = 0.0, .max = 10000.0}),
                          .tracked_share = stops.number("tracked_share", {.min = 0.0, .max = 1.0})},
                .surface_loss = stops.number("surface_loss", {.min = 0.0, .max = 1.0}),
                .worn_friction = stops.number("worn_friction", {.min = 0.01, .max = 1.0}),
                .worn_references = stops.numbers("worn_references", {.range = {.min = 0.01, .max = 0.5}}),
                .drawn_seed = draws.integer<std::uint64_t>("seed", {.min = 0}),
                .draws = draws.integer<std::size_t>("draws", {.min = 1, .max = 10000}),
                .min_drawn_j_mu = {},
                .parameters = {}};
    for (std::size_t i = 0; i < robust::kFamilyNames.size(); ++i)
        if (const auto min = draws.find_number(robust::kFamilyNames[i], {.min = 0.0, .max = 1.0}))
            s.min_drawn_j_mu.emplace_back(static_cast<robust::Family>(i), *min);
    for (const std::string& name : gain_names()) {
        const auto values = gains.numbers(name, {.range = {.min = 1e-6, .max = 1e4}, .count = {.min = 3, .max = 3}, .strictly_increasing = true});
        s.parameters.push_back({name, values[0], values[2], values[1]});
    }
    const auto named = [&](std::string_view key) {
        return *std::find_if(s.parameters.begin(), s.parameters.end(), [&](const Parameter& k) { return k.name == key; });
    };
    if (named("low_speed_floor_mps").high >= named("low_speed_mps").low)
        gains.fail("low_speed_floor_mps", "must end below where low_speed_mps begins");
    return s;
}

}  // namespace

MarginsSettings load_margins_settings(const std::filesystem::path& path) {
    const auto doc = settings::Document::load(path);
    const settings::Table asked = doc.root().table("requirement");
    const settings::Table pid = doc.root().table("pid");
    MarginsSettings s{.requirement = {.phase_deg = asked.number("phase_margin_deg", {.min = 0.0, .max = 90.0}),
                                      .gain_dB = asked.number("gain_margin_dB", {.min = 0.0, .max = 40.0})},
                      .pid = {.k_p_per_s = pid.number("k_p_per_s", {.min = 0.0, .max = 1e4}),
                              .k_i_per_s2 = pid.number("k_i_per_s2", {.min = 0.0, .max = 1e5}),
                              .k_d = pid.number("k_d", {.min = 0.0, .max = 100.0}),
                              .filter_s = 1e-3 * pid.number("filter_ms", {.min = 0.01, .max = 1000.0}),
                              .schedule = pid.number("schedule", {.min = 0.0, .max = 2.0})},
                      .law = law_search(doc.root().table("law"))};
    if (s.pid.k_p_per_s == 0.0 && s.pid.k_i_per_s2 == 0.0) pid.fail("k_p_per_s", "is 0 and so is k_i_per_s2: nothing would hold the slip");
    doc.finish();
    return s;
}

}  // namespace study::margins
