#include "rig_bridge/wear/population_io.hpp"

#include <fmt/format.h>

#include "firmware/host/settings/hash.hpp"
#include "firmware/host/settings/input_file.hpp"
#include "rig_bridge/wear/json_object.hpp"
#include "rig_bridge/wear/model_io.hpp"

namespace wear {

namespace {

using settings::Error;
using settings::Json;
using Reader = JsonObject;

double share(Reader& r, const std::string& file, const char* key) {
    const double value = r.number(key);
    if (value < 0.0 || value > 1.0) throw Error(file, 0, key, fmt::format("{} must be within 0 to 1", value));
    return value;
}

double not_negative(Reader& r, const std::string& file, const char* key) {
    const double value = r.number(key);
    if (value < 0.0) throw Error(file, 0, key, fmt::format("{} must not be negative", value));
    return value;
}

Scatter scatter_of(Reader r, const std::string& file) {
    Scatter s;
    s.memory = share(r, file, "memory");
    s.remembered = not_negative(r, file, "remembered");
    s.fresh = r.positive("fresh");
    s.drift_per_root_MJ = not_negative(r, file, "drift_per_root_MJ");
    r.finish();
    if (s.memory >= 1.0) throw Error(file, 0, "scatter.memory", "must be below 1");
    return s;
}

Spread spread_of(Reader r, const std::string& file) {
    Spread s;
    s.log_energy_scale = not_negative(r, file, "log_energy_scale");
    s.offset = not_negative(r, file, "offset");
    s.evidence_kept = share(r, file, "evidence_kept");
    r.finish();
    return s;
}

ForecastCalibration::Tenths tenths_of(const Json& list, const std::string& file, const char* key) {
    ForecastCalibration::Tenths out{};
    if (!list.is_array() || list.size() != out.size()) throw Error(file, 0, key, fmt::format("must be an array of {} numbers", out.size()));
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (!list[i].is_number() || !(list[i].get<double>() >= 0.0)) throw Error(file, 0, key, "must be numbers, not negative");
        out.at(i) = list[i].get<double>();
    }
    return out;
}

ForecastCalibration calibration_of(Reader r, const std::string& file) {
    ForecastCalibration c;
    c.log_misfit = r.number("log_misfit");
    c.misfit_deviation = not_negative(r, file, "misfit_deviation");
    c.filter = tenths_of(r.get("filter"), file, "calibration.filter");
    c.widening = tenths_of(r.get("widening"), file, "calibration.widening");
    r.finish();
    return c;
}

}  // namespace

std::string to_json(const Population& p) {
    Json models = Json::array();
    Json limits;
    for (std::size_t i = 0; i < kHealthTests.size(); ++i) limits[kHealthTestNames.at(i)] = p.limits.*kHealthTests.at(i);
    for (const Model& model : p.models) models.push_back(settings::parse_json(to_json(model)));
    const Json json{
        {"format", kPopulationFormat},
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
        {"calibration",
         {{"log_misfit", p.calibration.log_misfit},
          {"misfit_deviation", p.calibration.misfit_deviation},
          {"filter", p.calibration.filter},
          {"widening", p.calibration.widening}}},
        {"models", models}};
    return settings::json_page(json);
}

Population population_from_json(const std::string& name, std::string_view text) {
    const Json json = parsed_json(name, text);
    if (json.is_object() && json.contains("format") && json["format"] == kModelFormat) return population_of(from_json(name, text));
    Reader root(name, "", json);
    root.check_format(kPopulationFormat, kPopulationFormatVersion);
    Population out;
    out.source = root.text("source");
    Reader learnt = root.object("learnt_from");
    out.provenance = {learnt.origin(), learnt.count("lives", 1)};
    learnt.finish();
    out.scatter = scatter_of(root.object("scatter"), name);
    out.spread = spread_of(root.object("spread"), name);
    Reader steady = root.object("steady_stage");
    out.steady.from_J = not_negative(steady, name, "from_J");
    out.steady.to_J = not_negative(steady, name, "to_J");
    steady.finish();
    Reader limits = root.object("health_limits");
    for (std::size_t i = 0; i < kHealthTests.size(); ++i) out.limits.*kHealthTests.at(i) = limits.positive(kHealthTestNames.at(i));
    limits.finish();
    out.calibration = calibration_of(root.object("calibration"), name);
    const Json& models = root.get("models");
    root.finish();
    if (!models.is_array() || models.empty()) throw Error(name, 0, "models", "must be an array of models, not empty");
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
