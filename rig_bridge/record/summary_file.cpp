#include "rig_bridge/record/summary_file.hpp"

#include <fmt/format.h>

#include <limits>
#include <set>
#include <string_view>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/input_file.hpp"
#include "firmware/host/settings/json.hpp"
#include "rig_bridge/record/figure_fields.hpp"

namespace rig::record {

using settings::Json;

namespace {

constexpr std::string_view kFormat = "antiskid maneuver summary 1";

class Reader {
  public:
    Reader(const std::filesystem::path& path, const settings::Storage& storage) : path_(path.string()) {
        root_ = Json::parse(settings::read_file(path, settings::kMaxSettings, storage), nullptr, false);
        if (root_.is_discarded() || !root_.is_object()) throw settings::Error(path_, 0, "", "is no whole JSON object: expected a maneuver's summary");
    }

    std::string text(const char* key) { return get(key, &Json::is_string, "a text").get<std::string>(); }
    bool flag(const char* key) { return get(key, &Json::is_boolean, "true or false").get<bool>(); }
    double real(const char* key) {
        const Json& value = find(key);
        if (value.is_null()) return std::numeric_limits<double>::quiet_NaN();
        if (!value.is_number()) wrong(key, "a number");
        return value.get<double>();
    }
    template <typename T>
    T whole(const char* key) {
        const Json& value = find(key);
        if (!value.is_number_unsigned()) wrong(key, "a whole number, 0 or more");
        const auto unsigned_value = value.get<std::uint64_t>();
        if (unsigned_value > static_cast<std::uint64_t>(std::numeric_limits<T>::max())) wrong(key, "a smaller number");
        return static_cast<T>(unsigned_value);
    }
    std::vector<std::string> texts(const char* key) {
        std::vector<std::string> all;
        for (const Json& item : get(key, &Json::is_array, "a list of texts")) {
            if (!item.is_string()) wrong(key, "a list of texts");
            all.push_back(item.get<std::string>());
        }
        return all;
    }
    [[nodiscard]] bool has(const char* key) {
        known_.insert(key);
        const auto found = root_.find(key);
        return found != root_.end() && !found->is_null();
    }
    void finish() const {
        for (const auto& item : root_.items()) {
            if (!known_.contains(item.key())) throw settings::Error(path_, 0, item.key(), "unknown key");
        }
    }
    [[noreturn]] void wrong(const char* key, const std::string& expected) const { throw settings::Error(path_, 0, key, "expected " + expected); }

  private:
    const Json& find(const char* key) {
        known_.insert(key);
        const auto found = root_.find(key);
        if (found == root_.end()) throw settings::Error(path_, 0, key, "is missing");
        return *found;
    }
    const Json& get(const char* key, bool (Json::*is)() const noexcept, const char* expected) {
        const Json& value = find(key);
        if (!(value.*is)()) wrong(key, expected);
        return value;
    }

    std::string path_;
    Json root_;
    std::set<std::string, std::less<>> known_;
};

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
    Reader reader(path, storage);
    if (reader.text("format") != kFormat) reader.wrong("format", "\"" + std::string(kFormat) + "\"");
    Summary summary;
    summary.campaign = reader.text("campaign");
    summary.number = reader.whole<std::int64_t>("number");
    summary.scenario = reader.text("scenario");
    for (const SpecimenField& field : kSpecimenFields)  // older files have none
        if (reader.has(field.key)) summary.specimen.*field.value = reader.text(field.key);
    summary.outcome = reader.text("outcome");
    summary.started = reader.text("started");
    for (const FigureField& field : kFigureFields) summary.figures.*field.value = reader.real(field.key);
    summary.figures.standstill = reader.flag("standstill");
    summary.cumulative_energy_J = reader.real("cumulative_energy_J");
    summary.faults = reader.texts("faults");
    if (reader.has("out_of_tolerance")) summary.out_of_tolerance = reader.texts("out_of_tolerance");
    if (reader.has("warnings")) summary.warnings = reader.texts("warnings");  // older files have none
    summary.frames = reader.whole<std::uint64_t>("frames");
    summary.frames_dropped = reader.whole<std::uint64_t>("frames_dropped");
    summary.seed = reader.whole<std::uint64_t>("seed");
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
    std::string faults;
    for (const std::string& fault : summary.faults) faults += (faults.empty() ? "" : ", ") + fault;
    row("faults", faults.empty() ? "none" : faults);
    for (const std::string& warning : summary.warnings) row("warning", warning);
    row("frames", fmt::format("{}, {} dropped", summary.frames, summary.frames_dropped));
    return text;
}

}  // namespace rig::record
