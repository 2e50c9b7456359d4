#include "rig_bridge/wear/wear_campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "firmware/host/settings/csv_field.hpp"
#include "firmware/host/settings/hash.hpp"
#include "firmware/host/settings/input_file.hpp"
#include "firmware/host/settings/near_miss.hpp"
#include "rig_bridge/wear/csv_rows.hpp"

namespace wear {

namespace {

using settings::Error;

constexpr double kGreatestStep_J = 1e9;  // a heavy airliner's brake takes about 1e8 J in a rejected take-off
constexpr double kMinMeanStep_J = 100.0;
constexpr double kMinPlausible = 0.001;
constexpr double kGreatestPlausible = 1.5;

constexpr std::string_view kEnergyMJ = "cumulative_energy_MJ";
constexpr std::string_view kEnergyJ = "cumulative_energy_J";
constexpr std::string_view kFriction = "mean_friction";
constexpr std::string_view kLining = "lining_worn";

struct BrakingColumn {
    std::string_view name;
    double Braking::*value;
};
constexpr std::array<BrakingColumn, 3> kBraking{
    {{"brake_on_mps", &Braking::brake_on_mps}, {"mean_torque_Nm", &Braking::mean_torque_Nm}, {"mean_load_N", &Braking::mean_load_N}}};

struct Columns {
    std::size_t count = 0;
    std::size_t energy = 0;
    std::size_t friction = 0;
    double energy_unit_J = 1.0;
    std::string_view energy_name = kEnergyJ;
    std::optional<std::array<std::size_t, kBraking.size()>> braking;
    std::array<std::optional<std::size_t>, 2> parts;  ///< in the order of kPartColumns
    std::optional<std::size_t> lining;
};

struct PartColumn {
    std::string_view name;
    std::string Campaign::*value;
};
constexpr std::array<PartColumn, 2> kPartColumns{{{"brake_serial", &Campaign::brake}, {"disc_serial", &Campaign::disc}}};

std::optional<std::size_t> find(const std::vector<std::string_view>& header, std::string_view name, const std::string& file, unsigned line) {
    const auto at = std::find(header.begin(), header.end(), name);
    if (at == header.end()) return std::nullopt;
    if (std::find(at + 1, header.end(), name) != header.end()) throw Error(file, line, std::string(name), "two columns of this name");
    return static_cast<std::size_t>(at - header.begin());
}

/// Reason why the column is missing, with what the header has instead. `stem`: the name without its unit.
std::string missing(const std::vector<std::string_view>& header, std::string_view name, std::string_view stem) {
    for (const std::string_view got : header) {
        if (got == stem || (got.starts_with(stem) && got.substr(stem.size()).starts_with('_')))
            return fmt::format("'{}' is in another unit or in none; wanted is {}", settings::printable(got), name);
    }
    const std::string_view close = settings::nearest(name, header);
    return close.empty() ? fmt::format("no column {} in the header (first line, names separated by commas)", name)
                         : fmt::format("no column {}; is '{}' meant to be it?", name, settings::printable(close));
}

Columns columns_of(const std::string& file, unsigned line, const std::vector<std::string_view>& header) {
    if (header.size() == 1 && header.front().find_first_of(";\t") != std::string_view::npos)
        throw Error(file, line, "", "columns must be separated by commas");
    Columns c;
    c.count = header.size();
    const auto in_MJ = find(header, kEnergyMJ, file, line);
    const auto in_J = find(header, kEnergyJ, file, line);
    if (in_MJ && in_J)
        throw Error(file, line, std::string(kEnergyMJ), "energy stands in two units; keep cumulative_energy_J or cumulative_energy_MJ");
    if (!in_MJ && !in_J) throw Error(file, line, "", missing(header, kEnergyMJ, "cumulative_energy") + "; cumulative_energy_J will do, too");
    c.energy = in_MJ ? *in_MJ : *in_J;
    c.energy_unit_J = in_MJ ? 1e6 : 1.0;
    c.energy_name = in_MJ ? kEnergyMJ : kEnergyJ;
    const auto friction = find(header, kFriction, file, line);
    if (!friction) throw Error(file, line, "", missing(header, kFriction, kFriction));
    c.friction = *friction;
    for (std::size_t i = 0; i < kPartColumns.size(); ++i) c.parts[i] = find(header, kPartColumns[i].name, file, line);
    c.lining = find(header, kLining, file, line);
    std::array<std::size_t, kBraking.size()> braking{};
    for (std::size_t i = 0; i < kBraking.size(); ++i) {
        const auto at = find(header, kBraking[i].name, file, line);
        if (!at) return c;
        braking[i] = *at;
    }
    c.braking = braking;
    return c;
}

Braking braking_of(const std::string& file, unsigned line, const Columns& columns, const std::vector<std::string_view>& fields) {
    Braking out;
    for (std::size_t i = 0; i < kBraking.size(); ++i) {
        const double value = csv_number(file, line, kBraking[i].name, fields[(*columns.braking)[i]]);
        if (value <= 0.0) throw Error(file, line, std::string(kBraking[i].name), fmt::format("{} must be positive", value));
        out.*kBraking[i].value = value;
    }
    return out;
}

void take_parts(Campaign& campaign, unsigned line, const Columns& columns, const std::vector<std::string_view>& fields) {
    for (std::size_t i = 0; i < kPartColumns.size(); ++i) {
        if (!columns.parts[i]) continue;
        std::string is(fields[*columns.parts[i]]);
        for (auto at = is.find("\"\""); at != std::string::npos; at = is.find("\"\"", at + 1)) is.erase(at, 1);
        std::string& was = campaign.*kPartColumns[i].value;
        if (!campaign.points.empty() && is != was)
            throw Error(campaign.source, line, std::string(kPartColumns[i].name),
                        fmt::format("'{}' after '{}': their wear is not mixed; give each a table of its own", settings::printable(is),
                                    settings::printable(was)));
        was = std::move(is);
    }
}

void check_reading(const std::string& file, unsigned line, const LiningReading& reading) {
    if (!(reading.worn >= LiningReading::kMin && reading.worn <= LiningReading::kMax))
        throw Error(file, line, std::string(kLining),
                    fmt::format("{} is no worn share of a lining: 0 new, 1 at its limit ({} to {} with the reading's error); is it in percent?",
                                reading.worn, LiningReading::kMin, LiningReading::kMax));
}

void check_point(const std::string& file, unsigned line, const Point& point, const Point* before) {
    if (!std::isfinite(point.c_e_J) || point.c_e_J <= 0.0)
        throw Error(file, line, "cumulative_energy", fmt::format("{} J: cumulative energy is positive from the first maneuver on", point.c_e_J));
    if (!(point.mean_friction >= kMinPlausible && point.mean_friction <= kGreatestPlausible))
        throw Error(file, line, std::string(kFriction),
                    fmt::format("{} is no friction coefficient of a brake ({} to {}); is it in percent?", point.mean_friction, kMinPlausible,
                                kGreatestPlausible));
    if (before == nullptr) return;
    const double step_J = point.c_e_J - before->c_e_J;
    if (step_J <= 0.0)
        throw Error(file, line, "cumulative_energy",
                    fmt::format("{} J after {} J: energy must increase from maneuver to maneuver", point.c_e_J, before->c_e_J));
    if (step_J > kGreatestStep_J)
        throw Error(file, line, "cumulative_energy",
                    fmt::format("{} J in one maneuver is more than a brake takes ({} J); is the unit that of "
                                "the column's name, and the same in all rows?",
                                step_J, kGreatestStep_J));
}

constexpr std::string_view kOrigin = "# origin: ";

std::string origin_of(const std::string& name, std::string_view csv) {
    unsigned number = 1;
    for (std::size_t begin = 0; begin < csv.size() && csv[begin] == '#'; ++number) {
        const std::size_t end = std::min(csv.find('\n', begin), csv.size());
        std::string_view line = csv.substr(begin, end - begin);
        begin = end + 1;
        if (!line.starts_with(kOrigin)) continue;
        line.remove_prefix(kOrigin.size());
        if (line.ends_with('\r')) line.remove_suffix(1);
        if (!is_origin(line)) throw Error(name, number, "origin", "must begin with 'measured' or 'made up'");
        return settings::printable(line);
    }
    return kUnknownOrigin;
}

}  // namespace

void check(const Campaign& campaign, unsigned first_line) {
    const std::vector<Point>& points = campaign.points;
    if (points.size() < 2)
        throw Error(campaign.source, 0, "", fmt::format("{}: a campaign needs at least two", points.empty() ? "no maneuver" : "one maneuver only"));
    for (std::size_t i = 0; i < points.size(); ++i) {
        check_point(campaign.source, first_line + static_cast<unsigned>(i), points[i], i == 0 ? nullptr : &points[i - 1]);
    }
    for (const LiningReading& reading : campaign.readings) check_reading(campaign.source, 0, reading);
    const double mean_step_J = (points.back().c_e_J - points.front().c_e_J) / static_cast<double>(points.size() - 1);
    if (mean_step_J < kMinMeanStep_J)
        throw Error(campaign.source, 0, "cumulative_energy",
                    fmt::format("{} J a maneuver on average is less than a brake takes ({} J); is the unit "
                                "that of the column's name?",
                                mean_step_J, kMinMeanStep_J));
    const bool all_equal = std::all_of(points.begin(), points.end(), [&](const Point& p) { return p.mean_friction == points.front().mean_friction; });
    if (all_equal)
        throw Error(campaign.source, 0, std::string(kFriction),
                    fmt::format("{} in all {} maneuvers: no measurement is like that", points.front().mean_friction, points.size()));
}

Campaign parse_campaign(const std::string& name, std::string_view csv) {
    Campaign campaign;
    campaign.source = name;
    campaign.origin = origin_of(name, csv);
    std::optional<Columns> columns;
    for (CsvRows rows(csv); rows.next();) {
        const unsigned line_number = rows.line();
        const std::vector<std::string_view>& fields = rows.fields();
        if (!columns) {
            columns = columns_of(name, line_number, fields);
            continue;
        }
        if (fields.size() != columns->count)
            throw Error(name, line_number, "",
                        fmt::format("{} fields, but the header names {} columns (decimal point, comma between "
                                    "fields)",
                                    fields.size(), columns->count));
        take_parts(campaign, line_number, *columns, fields);
        const Point point{csv_number(name, line_number, columns->energy_name, fields[columns->energy]) * columns->energy_unit_J,
                          csv_number(name, line_number, kFriction, fields[columns->friction])};
        check_point(name, line_number, point, campaign.points.empty() ? nullptr : &campaign.points.back());
        campaign.points.push_back(point);
        if (columns->lining && !fields[*columns->lining].empty()) {
            campaign.readings.push_back({point.c_e_J, csv_number(name, line_number, kLining, fields[*columns->lining])});
            check_reading(name, line_number, campaign.readings.back());
        }
        if (columns->braking) campaign.brakings.push_back(braking_of(name, line_number, *columns, fields));
    }
    if (!columns) throw Error(name, 0, "", "empty: no header and no maneuver");
    check(campaign);
    return campaign;
}

Campaign read_campaign(const std::filesystem::path& csv) {
    return parse_campaign(csv.string(), settings::read_file(csv));
}

double brake_energy_J(const Campaign& campaign, std::size_t i) {
    const std::vector<Point>& p = campaign.points;
    if (i > 0) return p[i].c_e_J - p[i - 1].c_e_J;
    const double mean_step_J = (p.back().c_e_J - p.front().c_e_J) / static_cast<double>(p.size() - 1);
    return p[0].c_e_J <= 1.5 * mean_step_J ? p[0].c_e_J : std::numeric_limits<double>::quiet_NaN();
}

double taken_before_J(const Campaign& campaign) {
    if (!std::isnan(brake_energy_J(campaign, 0))) return 0.0;
    const std::vector<Point>& p = campaign.points;
    return p.front().c_e_J - (p.back().c_e_J - p.front().c_e_J) / static_cast<double>(p.size() - 1);
}

std::string to_csv(const Campaign& campaign) {
    const bool brakings = !campaign.brakings.empty();
    std::string csv = campaign.origin == kUnknownOrigin ? std::string() : fmt::format("{}{}\n", kOrigin, campaign.origin);
    csv += "maneuver,mean_friction,brake_energy_J,cumulative_energy_J";
    if (brakings) {
        for (const BrakingColumn& column : kBraking) csv.append(",").append(column.name);
    }
    for (const PartColumn& part : kPartColumns)
        if (!(campaign.*part.value).empty()) csv.append(",").append(part.name);
    if (!campaign.readings.empty()) csv.append(",").append(kLining);
    csv += "\n";
    auto reading = campaign.readings.begin();
    for (std::size_t i = 0; i < campaign.points.size(); ++i) {
        const Point& p = campaign.points[i];
        const double energy_J = brake_energy_J(campaign, i);
        fmt::format_to(std::back_inserter(csv), "{},{},{},{}", i + 1, p.mean_friction,
                       std::isnan(energy_J) ? std::string() : fmt::format("{}", energy_J), p.c_e_J);
        if (brakings) {
            for (const BrakingColumn& column : kBraking) fmt::format_to(std::back_inserter(csv), ",{}", campaign.brakings[i].*column.value);
        }
        for (const PartColumn& part : kPartColumns)
            if (!(campaign.*part.value).empty()) csv.append(",").append(settings::csv_field(campaign.*part.value));
        if (!campaign.readings.empty()) csv += ",";
        for (; reading != campaign.readings.end() && reading->c_e_J <= p.c_e_J; ++reading)
            if (reading + 1 == campaign.readings.end() || (reading + 1)->c_e_J > p.c_e_J)
                fmt::format_to(std::back_inserter(csv), "{}", reading->worn);
        csv += "\n";
    }
    return csv;
}

std::string data_hash(const Campaign& campaign) {
    Campaign data{campaign.source, campaign.points};
    data.readings = campaign.readings;
    const std::string csv = to_csv(data);
    const std::string_view bytes = csv;
    return settings::hash_bytes({&bytes, 1});
}

}  // namespace wear
