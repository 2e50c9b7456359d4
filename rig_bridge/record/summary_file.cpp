#include "rig_bridge/record/summary_file.hpp"

#include <fmt/format.h>

#include <limits>
#include <string_view>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/input_file.hpp"
#include "firmware/host/settings/json_object.hpp"
#include "rig_bridge/record/figure_fields.hpp"

namespace rig::record {

using settings::Json;

namespace {

constexpr std::string_view kFormat = "antiskid maneuver summary 1";

}  // namespace

void write_summary(const std::filesystem::path& path, const Summary& summary, const settings::Storage& storage) {
    Json json;
    json["format"] = kFormat;
    json["campaign"] = summary.campaign;
    json["number"] = summary.number;
    json["scenario"] = summary.scenario;
    for (const SpecimenField& field : kSpecimenFields) json[field.key] = summary.specimen.*field.value;
    json["outcome"] = summary.outcome;
    json["started"] = summary.started;
    for (const FigureField& field : kFigureFields) json[field.key] = summary.figures.*field.value;  // NaN becomes null
    json["standstill"] = summary.figures.standstill;
    json["cumulative_energy_J"] = summary.cumulative_energy_J;
    json["faults"] = summary.faults;
    json["out_of_tolerance"] = summary.out_of_tolerance ? Json(*summary.out_of_tolerance) : Json(nullptr);
    json["warnings"] = summary.warnings;
    json["frames"] = summary.frames;
    json["frames_dropped"] = summary.frames_dropped;
    json["seed"] = summary.seed;
    json["version"] = summary.version;
    json["config_hash"] = summary.config_hash;
    settings::write_file(path, settings::json_page(json), storage);
}

Summary read_summary(const std::filesystem::path& path, const settings::Storage& storage) {
    const Json json = settings::parsed_json(path.string(), settings::read_file(path, settings::kMaxSettings, storage));
    settings::JsonObject reader(path.string(), "", json);
    if (reader.text("format") != kFormat) reader.fail("format", fmt::format("must be '{}'", kFormat));
    Summary summary;
    summary.campaign = reader.text("campaign");
    summary.number = static_cast<std::int64_t>(reader.count("number", 0, std::numeric_limits<std::int64_t>::max()));
    summary.scenario = reader.text("scenario");
    for (const SpecimenField& field : kSpecimenFields)  // older files have none
        if (reader.has(field.key)) summary.specimen.*field.value = reader.text(field.key);
    summary.outcome = reader.text("outcome");
    summary.started = reader.text("started");
    for (const FigureField& field : kFigureFields) summary.figures.*field.value = reader.number_or_nan(field.key);
    summary.figures.standstill = reader.flag("standstill");
    summary.cumulative_energy_J = reader.number_or_nan("cumulative_energy_J");
    summary.faults = reader.texts("faults");
    if (reader.has("out_of_tolerance")) summary.out_of_tolerance = reader.texts("out_of_tolerance");
    if (reader.has("warnings")) summary.warnings = reader.texts("warnings");  // older files have none
    summary.frames = reader.count("frames");
    summary.frames_dropped = reader.count("frames_dropped");
    summary.seed = reader.count("seed");
    summary.version = reader.text("version");
    summary.config_hash = reader.text("config_hash");
    reader.finish();
    return summary;
}

std::string summary_table(const Summary& summary) {
    std::string text;
    const auto row = [&text](std::string_view label, const std::string& value) { text += fmt::format("{:<24}{}\n", label, value); };
    if (!summary.campaign.empty()) row("campaign", summary.campaign);
    if (summary.number > 0) row("maneuver", std::to_string(summary.number));
    row("scenario", summary.scenario);
    for (const SpecimenField& field : kSpecimenFields)
        if (const std::string& value = summary.specimen.*field.value; !value.empty()) row(field.label, value);
    row("outcome", summary.outcome);
    if (summary.out_of_tolerance)
        row("verdict",
            off_conditions(summary) ? fmt::format("out_of_tolerance: {}", fmt::join(*summary.out_of_tolerance, ", ")) : "within tolerance");
    for (const FigureField& field : kFigureFields) row(field.label, fmt::format("{:.5g} {}", summary.figures.*field.value * field.scale, field.unit));
    if (!summary.figures.standstill) row("standstill", "not reached");
    row("cumulative energy", fmt::format("{:.5g} MJ", summary.cumulative_energy_J * 1e-6));
    row("faults", summary.faults.empty() ? "none" : fmt::format("{}", fmt::join(summary.faults, ", ")));
    for (const std::string& warning : summary.warnings) row("warning", warning);
    row("frames", fmt::format("{}, {} dropped", summary.frames, summary.frames_dropped));
    return text;
}

}  // namespace rig::record
