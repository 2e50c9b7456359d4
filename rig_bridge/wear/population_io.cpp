#include "rig_bridge/wear/population_io.hpp"

#include <fmt/format.h>

#include "firmware/host/settings/hash.hpp"
#include "firmware/host/settings/input_file.hpp"
#include "rig_bridge/wear/model_io.hpp"

namespace wear {

namespace {

using settings::Json;
using Reader = settings::JsonObject;

double share(Reader& r, const char* key) {
    const double value = r.number(key);
    if (value < 0.0 || value > 1.0) r.fail(key, fmt::format("{} must be within 0 to 1", value));
    return value;
}

double not_negative(Reader& r, const char* key) {
    const double value = r.number(key);
    if (value < 0.0) r.fail(key, fmt::format("{} must not be negative", value));
    return value;
}

Scatter scatter_of(Reader r) {
    Scatter s;
    s.memory = share(r, "memory");
    s.remembered = not_negative(r, "remembered");
    s.fresh = r.positive("fresh");
    s.drift_per_root_MJ = not_negative(r, "drift_per_root_MJ");
    r.finish();
    if (s.memory >= 1.0) r.fail("memory", "must be below 1");
    return s;
}

Spread spread_of(Reader r) {
    Spread s;
    s.log_energy_scale = not_negative(r, "log_energy_scale");
    s.offset = not_negative(r, "offset");
    s.evidence_kept = share(r, "evidence_kept");
    r.finish();
    return s;
}

template <std::size_t Count>
std::array<double, Count> numbers_of(const Reader& r, const char* key, const Json& list) {
    std::array<double, Count> out{};
    if (!list.is_array() || list.size() != Count) r.fail(key, fmt::format("must be an array of {} numbers", Count));
    for (std::size_t i = 0; i < Count; ++i) {
        if (!list[i].is_number()) r.fail(key, "must be numbers");
        out.at(i) = list[i].get<double>();
    }
    return out;
}

LiningWear lining_of(Reader r) {
    LiningWear l;
    l.lives = r.count("lives", 1);
    l.slope = r.positive("slope");
    l.by_life = r.number("by_life");
    l.with_curve = numbers_of<kCurve>(r, "with_curve", r.get("with_curve"));
    l.variance = r.positive("variance");
    l.error = r.positive("error");
    l.evidence = share(r, "evidence");
    r.finish();
    return l;
}

Json json_of(const LiningWear& l) {
    return {{"lives", l.lives},       {"slope", l.slope}, {"by_life", l.by_life},  {"with_curve", l.with_curve},
            {"variance", l.variance}, {"error", l.error}, {"evidence", l.evidence}};
}

LifeCurves curves_of(Reader r) {
    LifeCurves c;
    c.lives = r.count("lives", 3);
    c.limit = not_negative(r, "limit");
    c.landing_J = r.positive("landing_J");
    c.log_life = r.number("log_life");
    c.log_life_deviation = r.positive("log_life_deviation");
    c.mean = numbers_of<kCurve>(r, "mean", r.get("mean"));
    c.by_life = numbers_of<kCurve>(r, "by_life", r.get("by_life"));
    const Json& covariance = r.get("covariance");
    if (!covariance.is_array() || covariance.size() != kCurve) r.fail("covariance", fmt::format("must be {} rows", kCurve));
    for (std::size_t i = 0; i < kCurve; ++i) c.covariance.at(i) = numbers_of<kCurve>(r, "covariance", covariance[i]);
    c.energy = numbers_of<kEnergiesBefore>(r, "energy", r.get("energy"));
    c.memory = share(r, "memory");
    c.remembered = not_negative(r, "remembered");
    c.fresh = r.positive("fresh");
    c.evidence = share(r, "evidence");
    c.walk = not_negative(r, "walk");
    c.noise = r.positive("noise");
    if (r.has("lining")) c.lining = lining_of(r.object("lining"));
    r.finish();
    return c;
}

Json json_of(const LifeCurves& c) {
    Json json{{"lives", c.lives},
              {"limit", c.limit},
              {"landing_J", c.landing_J},
              {"log_life", c.log_life},
              {"log_life_deviation", c.log_life_deviation},
              {"mean", c.mean},
              {"by_life", c.by_life},
              {"covariance", c.covariance},
              {"energy", c.energy},
              {"memory", c.memory},
              {"remembered", c.remembered},
              {"fresh", c.fresh},
              {"evidence", c.evidence},
              {"walk", c.walk},
              {"noise", c.noise}};
    if (c.lining.lives > 0) json["lining"] = json_of(c.lining);
    return json;
}

}  // namespace

std::string to_json(const Population& p) {
    Json models = Json::array();
    Json limits;
    for (std::size_t i = 0; i < kHealthTests.size(); ++i) limits[kHealthTestNames.at(i)] = p.limits.*kHealthTests.at(i);
    for (const Model& model : p.models) models.push_back(settings::parse_json(to_json(model)));
    Json json{{"format", kPopulationFormat},
              {"format_version", kPopulationFormatVersion},
              {"source", p.source},
              {"learnt_from", json_of(p.provenance)},
              {"scatter",
               {{"memory", p.scatter.memory},
                {"remembered", p.scatter.remembered},
                {"fresh", p.scatter.fresh},
                {"drift_per_root_MJ", p.scatter.drift_per_root_MJ}}},
              {"spread", {{"log_energy_scale", p.spread.log_energy_scale}, {"offset", p.spread.offset}, {"evidence_kept", p.spread.evidence_kept}}},
              {"steady_stage", {{"from_J", p.steady.from_J}, {"to_J", p.steady.to_J}}},
              {"health_limits", limits},
              {"models", models}};
    if (p.curves.lives > 0) json["life_curves"] = json_of(p.curves);
    return settings::json_page(json);
}

Population population_from_json(const std::string& name, std::string_view text) {
    const Json json = settings::parsed_json(name, text);
    if (json.is_object() && json.contains("format") && json["format"] == kModelFormat) return population_of(from_json(name, text));
    Reader root(name, "", json);
    root.check_format(kPopulationFormat, kPopulationFormatVersion);
    Population out;
    out.source = root.text("source");
    Reader learnt = root.object("learnt_from");
    out.provenance = {origin_in(learnt), learnt.count("lives", 1)};
    learnt.finish();
    out.scatter = scatter_of(root.object("scatter"));
    out.spread = spread_of(root.object("spread"));
    Reader steady = root.object("steady_stage");
    out.steady.from_J = not_negative(steady, "from_J");
    out.steady.to_J = not_negative(steady, "to_J");
    steady.finish();
    Reader limits = root.object("health_limits");
    for (std::size_t i = 0; i < kHealthTests.size(); ++i) out.limits.*kHealthTests.at(i) = limits.positive(kHealthTestNames.at(i));
    limits.finish();
    if (root.has("life_curves")) out.curves = curves_of(root.object("life_curves"));
    const Json& models = root.get("models");
    root.finish();
    if (!models.is_array() || models.empty()) root.fail("models", "must be an array of models, not empty");
    out.models.reserve(models.size());
    out.members.reserve(models.size());
    for (std::size_t i = 0; i < models.size(); ++i) {
        out.models.push_back(from_json(fmt::format("{}: models[{}]", name, i), models[i].dump()));
        out.members.emplace_back(out.models.back());
    }
    return out;
}

PopulationFile read_population(const std::filesystem::path& json) {
    const std::string text = settings::read_file(json);
    const std::string_view bytes = text;
    return {population_from_json(json.string(), text), settings::hash_bytes({&bytes, 1})};
}

}  // namespace wear
