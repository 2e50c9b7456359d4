#include "rig_bridge/wear/regulation_config.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "firmware/host/settings/csv_field.hpp"
#include "firmware/host/settings/settings.hpp"

namespace wear {

namespace {

constexpr settings::Range kEnergy_J{.min = 1e3, .max = 1e15};

}  // namespace

SurfaceTable load_surface_table(const std::filesystem::path& file) {
    const settings::Document doc = settings::Document::load(file);
    const settings::Table root = doc.root();
    SurfaceTable table;
    table.reference = root.numbers("slip_reference", {.range = {.min = 0.01, .max = 0.5}, .count = {.min = 2}, .strictly_increasing = true});
    const settings::Count count{.min = table.reference.size(), .max = table.reference.size()};
    for (const settings::Table& surface : root.tables("surfaces"))
        table.rows.push_back(
            {.surface = surface.name(),
             .j_mu = surface.numbers("j_mu", {.range = {.min = 0.0, .max = 1.05}, .count = count}),
             .tyre_share = surface.numbers("tyre_share", {.range = {.min = 0.001, .max = 0.999}, .count = count, .strictly_increasing = true}),
             .distance_m = surface.numbers("distance_m", {.range = {.min = 1.0, .max = 1e5}, .count = count})});
    doc.finish();
    return table;
}

std::string to_toml(const SurfaceTable& table, const std::string& made_by) {
    std::string text = fmt::format(
        "# What a slip reference gives on each surface, in all maneuvers, with a new brake and a worn one: the least J_mu of eq. (16), the tyre's\n"
        "# share of brake and tyre energy, the mean length of the stop. Made by\n"
        "#\n#     {}\n\n",
        made_by);
    auto out = std::back_inserter(text);
    fmt::format_to(out, "slip_reference = [{:.2f}]\n", fmt::join(table.reference, ", "));
    for (const SurfaceTable::Row& row : table.rows)
        fmt::format_to(out, "\n[surfaces.{}]\nj_mu = [{:.4f}]\ntyre_share = [{:.4f}]\ndistance_m = [{:.1f}]\n", row.surface,
                       fmt::join(row.j_mu, ", "), fmt::join(row.tyre_share, ", "), fmt::join(row.distance_m, ", "));
    return text;
}

std::vector<std::string> surfaces_of(const SurfaceTable& table, const std::string& text) {
    std::vector<std::string> known;
    known.reserve(table.rows.size());
    for (const SurfaceTable::Row& row : table.rows) known.push_back(row.surface);
    if (text == "all") return known;
    std::vector<std::string> named;
    std::istringstream in(text);
    for (std::string name; std::getline(in, name, ',');) {
        name = settings::trimmed(name);
        if (table.find(name) == nullptr)
            throw std::invalid_argument(
                fmt::format("'{}' is no surface of the table of J_mu: expected all, or of {}, "
                            "with commas between",
                            name, fmt::join(known, ", ")));
        named.push_back(name);
    }
    return named;
}

RegulationConfig load_regulation_config(const std::filesystem::path& file) {
    const settings::Document doc = settings::Document::load(file);
    const settings::Table root = doc.root();
    RegulationConfig config;
    const settings::Table plan = root.table("plan");
    config.plan.landings = plan.find_integer<int>("landings", {.min = 2, .max = 1'000'000}).value_or(0);
    config.plan.brake_taken_J = plan.number("brake_taken_J", {.min = 0.0, .max = 1e15});
    config.plan.tyre_life_J = plan.number("tyre_life_J", kEnergy_J);
    config.plan.tyre_taken_J = plan.number("tyre_taken_J", {.min = 0.0, .max = 1e15});
    if (config.plan.tyre_taken_J >= config.plan.tyre_life_J) plan.fail("tyre_taken_J", "is not below tyre_life_J: nothing is left to share");
    config.plan.tolerance = plan.number("tolerance", {.min = 0.001, .max = 0.5});
    const settings::Table reference = root.table("reference");
    config.rules.default_reference = reference.number("default", {.min = 0.01, .max = 0.5});
    config.rules.step = reference.number("step", {.min = 0.001, .max = 0.5});
    config.rules.max_unmeasured_landings = reference.integer<int>("patience_landings", {.min = 0, .max = 1000});
    const settings::Table measurement = root.table("measurement");
    config.rules.energy_tolerance = measurement.number("books_tolerance", {.min = 0.001, .max = 0.9});
    config.rules.adaptation = measurement.number("adaptation", {.min = 0.001, .max = 1.0});
    const settings::Table floor = root.table("floor");
    config.rules.j_mu_floor = floor.number("j_mu", {.min = 0.0, .max = 1.0});
    const std::filesystem::path table = file.parent_path() / floor.text("table");
    config.floor = load_surface_table(table);
    try {
        config.surfaces = surfaces_of(config.floor, floor.find_text("surfaces").value_or("all"));
    } catch (const std::invalid_argument& e) {
        floor.fail("surfaces", e.what());
    }
    if (const auto forecast = root.find_table("forecast")) config.forecast_widest = forecast->number("widest", {.min = 0.01, .max = 1.0});
    const settings::Table deviations = root.table("deviations");
    const auto deviation = [&](const char* key) { return deviations.number(key, {.min = 0.0, .max = 0.5}); };
    config.deviations = {.brake = deviation("brake_life"), .tyre = deviation("tyre_life"), .inspection = deviation("inspection")};
    const settings::Table prices = root.table("prices");
    const auto price = [&](const char* key) { return prices.number(key, {.min = 0.0, .max = 1e9}); };
    config.prices = {.brake = price("brake"), .tyre = price("tyre"), .visit = price("visit"), .metre = price("metre")};
    config.files = {file, table};
    doc.finish();
    try {  // also for surfaces that are not listed: one of them may occur later
        for (const SurfaceTable::Row& row : config.floor.rows) static_cast<void>(config.range_on(row.surface));
    } catch (const std::invalid_argument& e) {
        floor.fail("j_mu", e.what());
    }
    return config;
}

Range RegulationConfig::range_on(const std::string& surface) const {
    return allowed(floor, std::array{surface}, rules.j_mu_floor, rules.default_reference);
}

Range RegulationConfig::range(const std::string& surface) const {
    std::vector<std::string> all = surfaces;
    if (!surface.empty()) all.push_back(surface);
    return allowed(floor, all, rules.j_mu_floor, rules.default_reference);
}

WearPlan plan_of(const RegulationConfig& config, double brake_life_J, double landing_J, double landing_deviation_J) {
    WearPlan plan = config.plan;
    if (plan.brake_taken_J >= brake_life_J)
        throw settings::Error(config.files.front().string(), 0, "plan.brake_taken_J",
                              fmt::format("is {:.4g}, the brake's life {:.4g}: nothing is left to share", plan.brake_taken_J, brake_life_J));
    plan.brake_life_J = brake_life_J;
    plan.landing_J = landing_J;
    plan.landing_deviation_J = landing_deviation_J;
    if (plan.landings == 0) {
        const double left_J = plan.brake_budget_J() + plan.tyre_budget_J();
        plan.landings = std::max(1, static_cast<int>(std::lround(left_J / landing_J)));
    }
    return plan;
}

}  // namespace wear
