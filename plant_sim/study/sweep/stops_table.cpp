#include "plant_sim/study/sweep/stops_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <type_traits>

#include "firmware/can/names.hpp"
#include "firmware/can/value_names.hpp"
#include "firmware/host/settings/input_file.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/number_in.hpp"

namespace sweep {

namespace {

using settings::Error;
using study::StopFigures;

constexpr std::string_view kFormat = "# antiskid sweep 1 ";
constexpr std::string_view kStopColumns = "stop,law,slip_reference,landing,surface,maneuver,c_e_J,mean_friction,sensor_seed,standstill,faults";

struct Figure {
    std::string_view name;
    std::optional<double> (*get)(const StopFigures&);
    void (*set)(StopFigures&, double);
    bool may_be_empty;  // where it was not measured
};

template <auto Member>
constexpr Figure figure(std::string_view name) {
    return {name, [](const StopFigures& f) -> std::optional<double> { return f.*Member; }, [](StopFigures& f, double value) { f.*Member = value; },
            std::is_same_v<decltype(Member), std::optional<double> StopFigures::*>};
}

constexpr std::array kFigures{figure<&StopFigures::j_mu>("j_mu"),
                              figure<&StopFigures::stop_distance_m>("stop_distance_m"),
                              figure<&StopFigures::duration_s>("duration_s"),
                              figure<&StopFigures::drop_out_distance_m>("drop_out_distance_m"),
                              figure<&StopFigures::energy_brake_J>("energy_brake_J"),
                              figure<&StopFigures::energy_tyre_J>("energy_tyre_J"),
                              figure<&StopFigures::energy_residual>("energy_residual"),
                              figure<&StopFigures::slip_efficiency>("slip_efficiency"),
                              figure<&StopFigures::tracked_share>("tracked_share"),
                              figure<&StopFigures::tracked_tyre_share>("tracked_tyre_share"),
                              figure<&StopFigures::peak_slip>("peak_slip"),
                              figure<&StopFigures::longest_lock_s>("longest_lock_s"),
                              figure<&StopFigures::mean_friction>("measured_friction"),
                              figure<&StopFigures::mean_torque_Nm>("mean_torque_Nm"),
                              figure<&StopFigures::mean_load_N>("mean_load_N"),
                              figure<&StopFigures::valve_travel_mAps>("valve_travel_mAps")};

std::string field(const std::optional<double>& value) {
    return value ? fmt::format("{}", *value) : std::string();
}

std::string column_names() {
    std::string names(kStopColumns);
    for (const Figure& figure : kFigures) names.append(",").append(figure.name);
    return names + "\n";
}

/// Fields of one line, read from left to right; errors name file, line and column.
class Fields {
  public:
    Fields(const std::string& name, std::uint32_t line, std::string_view text) : name_(name), line_(line), left_(text) {}

    std::string_view next(std::string_view column) {
        if (done_) throw Error(name_, line_, std::string(column), "the line ends before it");
        const auto comma = left_.find(',');
        const std::string_view field = left_.substr(0, comma);
        done_ = comma == std::string_view::npos;
        left_ = done_ ? std::string_view{} : left_.substr(comma + 1);
        return field;
    }

    template <typename Number>
    Number number(std::string_view column) {
        return number<Number>(column, next(column));
    }

    template <typename Number>
    Number number(std::string_view column, std::string_view text) const {
        const auto value = settings::number_in<Number>(text);
        if (!value || !std::isfinite(static_cast<double>(*value))) reject(column, text, "a number");
        return *value;
    }

    bool choice(std::string_view column, std::string_view yes, std::string_view no) {
        const std::string_view text = next(column);
        if (text != yes && text != no) reject(column, text, fmt::format("{} or {}", yes, no));
        return text == yes;
    }

    void finish() const {
        if (!done_) throw Error(name_, line_, "", "the line has more fields than the table has columns");
    }

    [[noreturn]] void reject(std::string_view column, std::string_view got, std::string_view expected) const {
        constexpr std::size_t kShown = 40;
        throw Error(name_, line_, std::string(column), fmt::format("'{}': expected {}", got.substr(0, kShown), expected));
    }

  private:
    const std::string& name_;
    std::uint32_t line_;
    std::string_view left_;
    bool done_ = false;
};

antiskid::control::FaultSet faults_of(Fields& fields) {
    antiskid::control::FaultSet faults;
    const std::string_view all = fields.next("faults");
    for (std::string_view left = all; left != "none";) {
        const auto space = left.find(' ');
        const auto* known = std::find(antiskid::can::kFaultNames.begin(), antiskid::can::kFaultNames.end(), left.substr(0, space));
        if (known == antiskid::can::kFaultNames.end()) fields.reject("faults", all, "names of faults, or none");
        faults.insert(static_cast<antiskid::control::Fault>(std::distance(antiskid::can::kFaultNames.begin(), known)));
        if (space == std::string_view::npos) break;
        left.remove_prefix(space + 1);
    }
    return faults;
}

void check_identity(const std::string& name, const Identity& id) {
    constexpr std::size_t kMax = 100'000'000;
    const bool increasing = std::adjacent_find(id.references.begin(), id.references.end(), std::greater_equal<>()) == id.references.end();
    if (id.landings == 0 || id.landings > kMax || id.references.size() > kMax / id.landings || !increasing)
        throw Error(name, 1, "references", "no sweep has such references and landings");
}

}  // namespace

Identity identity_of(const SweepPlan& plan) {
    return {.version = plan.version,
            .config_hash = plan.config_hash,
            .seed = plan.seed,
            .references = plan.references,
            .landings = plan.landings.size(),
            .threshold = plan.threshold};
}

std::string difference(const Identity& got, const Identity& wanted) {
    if (got.version != wanted.version) return fmt::format("version {} instead of {}", got.version, wanted.version);
    if (got.config_hash != wanted.config_hash) return fmt::format("configuration {} instead of {}", got.config_hash, wanted.config_hash);
    if (got.seed != wanted.seed) return fmt::format("seed {} instead of {}", got.seed, wanted.seed);
    if (got.landings != wanted.landings) return fmt::format("{} landings instead of {}", got.landings, wanted.landings);
    if (got.references != wanted.references)
        return fmt::format("other slip references ({} from {} to {} instead of {} from {} to {})", got.references.size(),
                           got.references.empty() ? 0.0 : got.references.front(), got.references.empty() ? 0.0 : got.references.back(),
                           wanted.references.size(), wanted.references.empty() ? 0.0 : wanted.references.front(),
                           wanted.references.empty() ? 0.0 : wanted.references.back());
    if (got.threshold != wanted.threshold)
        return got.threshold ? "with the threshold law instead of without" : "without the threshold law instead of with it";
    return {};
}

std::string head(const Identity& identity) {
    const settings::Json json{{"version", identity.version},       {"config_hash", identity.config_hash}, {"seed", identity.seed},
                              {"references", identity.references}, {"landings", identity.landings},       {"threshold", identity.threshold}};
    return fmt::format("{}{}\n{}", kFormat, json.dump(), column_names());
}

std::string line(const SweptStop& row) {
    const Stop& s = row.stop;
    std::string out = fmt::format("{},{},{},{},{},{},{},{},{},{},{}", s.number, s.threshold ? "threshold" : "slip", s.slip_reference, s.landing,
                                  s.surface, s.maneuver, s.c_e_J, s.mean_friction, s.sensor_seed, row.figures.standstill ? "yes" : "no",
                                  row.faults.empty() ? "none" : fmt::format("{}", fmt::join(antiskid::can::fault_names(row.faults), " ")));
    for (const Figure& figure : kFigures) out.append(",").append(field(figure.get(row.figures)));
    out.push_back('\n');
    return out;
}

std::string to_csv(const Identity& identity, std::span<const SweptStop> rows) {
    std::string csv = head(identity);
    for (const SweptStop& row : rows) csv += line(row);
    return csv;
}

SweptStop parse_row(const std::string& name, std::uint32_t line_number, std::string_view text) {
    Fields fields(name, line_number, text);
    SweptStop row;
    Stop& s = row.stop;
    s.number = fields.number<std::size_t>("stop");
    s.threshold = fields.choice("law", "threshold", "slip");
    s.slip_reference = fields.number<double>("slip_reference");
    s.landing = fields.number<std::size_t>("landing");
    s.surface = fields.next("surface");
    s.maneuver = fields.next("maneuver");
    s.c_e_J = fields.number<double>("c_e_J");
    s.mean_friction = fields.number<double>("mean_friction");
    s.sensor_seed = fields.number<std::uint64_t>("sensor_seed");
    row.figures.standstill = fields.choice("standstill", "yes", "no");
    row.faults = faults_of(fields);
    for (const Figure& figure : kFigures) {
        const std::string_view shown = fields.next(figure.name);
        if (!shown.empty() || !figure.may_be_empty) figure.set(row.figures, fields.number<double>(figure.name, shown));
    }
    fields.finish();
    return row;
}

StopsTable parse_stops(const std::string& name, std::string_view csv) {
    StopsTable table{.name = name};
    std::vector<bool> seen;
    std::uint32_t number = 0;
    while (!csv.empty()) {
        const auto end = csv.find('\n');
        if (end == std::string_view::npos) break;
        const std::string_view text = csv.substr(0, end);
        csv.remove_prefix(end + 1);
        table.whole += end + 1;
        ++number;
        if (number == 1) {
            if (!text.starts_with(kFormat))
                throw Error(name, 1, "", "this is no table of a sweep's stops; its first line begins with '" + std::string(kFormat) + "'");
            try {
                const auto json = settings::parse_json(text.substr(kFormat.size()));
                table.identity = {.version = json.at("version").get<std::string>(),
                                  .config_hash = json.at("config_hash").get<std::string>(),
                                  .seed = json.at("seed").get<std::uint64_t>(),
                                  .references = json.at("references").get<std::vector<double>>(),
                                  .landings = json.at("landings").get<std::size_t>(),
                                  .threshold = json.at("threshold").get<bool>()};
            } catch (const settings::Json::exception& e) {
                throw Error(name, 1, "", std::string("damaged first line: ") + e.what());
            }
            check_identity(name, table.identity);
            seen.resize(table.identity.stops());
            continue;
        }
        if (number == 2) {
            if (std::string(text) + "\n" != column_names()) throw Error(name, 2, "", "other columns than this version's: " + column_names());
            continue;
        }
        SweptStop row = parse_row(name, number, text);
        const std::size_t reference = row.stop.number / table.identity.landings;
        if (row.stop.number >= seen.size() || seen[row.stop.number])
            throw Error(name, number, "stop", fmt::format("{} stands in the table twice, or is not of this sweep", row.stop.number));
        seen[row.stop.number] = true;
        if (row.stop.landing != row.stop.number % table.identity.landings || row.stop.threshold != (reference == table.identity.references.size()) ||
            row.stop.slip_reference != (row.stop.threshold ? 0.0 : table.identity.references[reference]))
            throw Error(name, number, "stop", fmt::format("{} has another law, reference or landing in this sweep", row.stop.number));
        table.rows.push_back(std::move(row));
    }
    if (number < 2) throw Error(name, 0, "", "this is no table of a sweep's stops: its first two lines are not whole");
    return table;
}

StopsTable read_stops(const std::filesystem::path& csv) {
    constexpr std::size_t kMaxBytes = std::size_t{4} << 30U;
    return parse_stops(csv.string(), settings::read_file(csv, kMaxBytes));
}

}  // namespace sweep
