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
constexpr std::string_view kBrakeEnergy = "brake_energy_J";
constexpr std::string_view kOutcome = "outcome";
constexpr std::string_view kFinished = "finished";
constexpr std::string_view kOutOfTolerance = "out_of_tolerance";
constexpr std::string_view kLeftOut = "left_out";

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
    std::optional<std::size_t> lining, outcome, brake_energy;
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
    c.outcome = find(header, kOutcome, file, line);
    c.brake_energy = find(header, kBrakeEnergy, file, line);
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

void take_parts(Campaign& campaign, bool first, unsigned line, const Columns& columns, const std::vector<std::string_view>& fields) {
    for (std::size_t i = 0; i < kPartColumns.size(); ++i) {
        if (!columns.parts[i]) continue;
        std::string is(fields[*columns.parts[i]]);
        for (auto at = is.find("\"\""); at != std::string::npos; at = is.find("\"\"", at + 1)) is.erase(at, 1);
        std::string& was = campaign.*kPartColumns[i].value;
        if (!first && is != was)
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

void check_step(const std::string& file, unsigned line, double step_J) {
    if (step_J > kGreatestStep_J)
        throw Error(file, line, "cumulative_energy",
                    fmt::format("{} J in one maneuver is more than a brake takes ({} J); is the unit that of "
                                "the column's name, and the same in all rows?",
                                step_J, kGreatestStep_J));
}

/// `before_J`: energy after the row before; none: it is the first.
void check_point(const std::string& file, unsigned line, const Point& point, std::optional<double> before_J) {
    if (!std::isfinite(point.c_e_J) || point.c_e_J <= 0.0)
        throw Error(file, line, "cumulative_energy", fmt::format("{} J: cumulative energy is positive from the first maneuver on", point.c_e_J));
    if (!(point.mean_friction >= kMinPlausible && point.mean_friction <= kGreatestPlausible))
        throw Error(file, line, std::string(kFriction),
                    fmt::format("{} is no friction coefficient of a brake ({} to {}); is it in percent?", point.mean_friction, kMinPlausible,
                                kGreatestPlausible));
    if (!before_J) return;
    if (point.c_e_J <= *before_J)
        throw Error(file, line, "cumulative_energy",
                    fmt::format("{} J after {} J: energy must increase from maneuver to maneuver", point.c_e_J, *before_J));
    check_step(file, line, point.c_e_J - *before_J);
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

/// Takes a campaign row by row.
class Parser {
  public:
    explicit Parser(const std::string& name) : name_(name) { campaign_.source = name; }

    void take(unsigned line, const std::vector<std::string_view>& fields) {
        if (!columns_) {
            columns_ = columns_of(name_, line, fields);
            return;
        }
        if (fields.size() != columns_->count)
            throw Error(name_, line, "",
                        fmt::format("{} fields, but the header names {} columns (decimal point, comma between "
                                    "fields)",
                                    fields.size(), columns_->count));
        take_parts(campaign_, !before_J_, line, *columns_, fields);
        const double c_e_J = csv_number(name_, line, columns_->energy_name, fields[columns_->energy]) * columns_->energy_unit_J;
        const bool point = is_point(line, fields, c_e_J);
        if (point) take_point(line, fields, c_e_J);
        if (point || (columns_->outcome && fields[*columns_->outcome] == kOutOfTolerance)) take_landing(line, fields, c_e_J);
        if (columns_->lining && !fields[*columns_->lining].empty() && c_e_J > 0.0) {
            campaign_.readings.push_back({c_e_J, csv_number(name_, line, kLining, fields[*columns_->lining])});
            check_reading(name_, line, campaign_.readings.back());
        }
        before_J_ = campaign_.taken_J = c_e_J;
    }

    [[nodiscard]] Campaign campaign() && {
        if (!columns_) throw Error(name_, 0, "", "empty: no header and no maneuver");
        if (not_finished_ > 0) campaign_.source += fmt::format(" ({} not finished left out)", not_finished_);
        if (out_of_tolerance_ > 0) campaign_.source += fmt::format(" ({} out of tolerance left out)", out_of_tolerance_);
        if (without_energy_ > 0) campaign_.source += fmt::format(" ({} that add no energy left out)", without_energy_);
        check(campaign_);
        const double first_J = brake_energy_J(campaign_, 0), c_e_J = campaign_.points.front().c_e_J;
        std::vector<LandingEnergy>& landings = campaign_.landings;
        if (!std::isnan(first_J) && (landings.empty() || landings.front().c_e_J > c_e_J)) landings.insert(landings.begin(), {c_e_J, first_J});
        return std::move(campaign_);
    }

  private:
    /// A row with another outcome adds energy and readings alone.
    bool is_point(unsigned line, const std::vector<std::string_view>& fields, double c_e_J) {
        if (!columns_->outcome) return true;
        const std::string_view outcome = fields[*columns_->outcome];
        const double step_J = c_e_J - before_J_.value_or(0.0);
        if (step_J < 0.0)
            throw Error(name_, line, "cumulative_energy", fmt::format("{} J after {} J: energy cannot decrease", c_e_J, before_J_.value_or(0.0)));
        if (before_J_) check_step(name_, line, step_J);
        if (outcome == kFinished && step_J > 0.0) return true;
        if (outcome == kFinished) ++without_energy_;
        if (outcome == kOutOfTolerance) ++out_of_tolerance_;
        if (outcome != kFinished && outcome != kOutOfTolerance && outcome != kLeftOut) ++not_finished_;
        return false;
    }

    void take_point(unsigned line, const std::vector<std::string_view>& fields, double c_e_J) {
        const Point point{c_e_J, csv_number(name_, line, kFriction, fields[columns_->friction])};
        check_point(name_, line, point, before_J_);
        campaign_.points.push_back(point);
        if (columns_->braking) campaign_.brakings.push_back(braking_of(name_, line, *columns_, fields));
    }

    void take_landing(unsigned line, const std::vector<std::string_view>& fields, double c_e_J) {
        const double step_J = c_e_J - before_J_.value_or(0.0);
        if (columns_->brake_energy && !fields[*columns_->brake_energy].empty()) {
            constexpr double kRounded = 1.001;
            const double rise_J = c_e_J - landed_J_;
            const double energy_J = csv_number(name_, line, kBrakeEnergy, fields[*columns_->brake_energy]);
            if (!(energy_J > 0.0 && energy_J <= kRounded * rise_J))
                throw Error(name_, line, std::string(kBrakeEnergy), fmt::format("{} J, but the cumulative energy rises by {} J", energy_J, rise_J));
            campaign_.landings.push_back({c_e_J, energy_J});
        } else if (before_J_ && step_J > 0.0) {
            campaign_.landings.push_back({c_e_J, step_J});
        }
        landed_J_ = c_e_J;
    }

    std::string name_;
    Campaign campaign_;
    std::optional<Columns> columns_;
    std::optional<double> before_J_;  ///< energy after the row before
    double landed_J_ = 0.0;           ///< energy after the landing before
    std::size_t not_finished_ = 0, out_of_tolerance_ = 0, without_energy_ = 0;
};

/// A row of the written table.
struct Row {
    double c_e_J = 0.0;
    std::optional<std::size_t> point{};
    double energy_J = std::numeric_limits<double>::quiet_NaN();  ///< of a landing
    std::optional<double> worn{};
};

/// Points, and rows of their own for other landings, for the readings that were not made after one of them or are not the only one there, and for
/// what was taken since.
std::vector<Row> rows_of(const Campaign& campaign) {
    std::vector<Row> rows;
    for (std::size_t i = 0; i < campaign.points.size(); ++i) rows.push_back({campaign.points[i].c_e_J, i, brake_energy_J(campaign, i)});
    const auto first_after = [&](double energy_J) {
        return std::upper_bound(rows.begin(), rows.end(), energy_J, [](double c_e_J, const Row& row) { return c_e_J < row.c_e_J; });
    };
    for (const LandingEnergy& landing : campaign.landings) {
        const auto after = first_after(landing.c_e_J);
        if (after == rows.begin() || std::prev(after)->c_e_J != landing.c_e_J) rows.insert(after, {landing.c_e_J, std::nullopt, landing.energy_J});
    }
    for (const LiningReading& reading : campaign.readings) {
        const auto after = first_after(reading.c_e_J);
        if (after != rows.begin() && std::prev(after)->c_e_J == reading.c_e_J && !std::prev(after)->worn)
            std::prev(after)->worn = reading.worn;
        else
            rows.insert(after, {.c_e_J = reading.c_e_J, .worn = reading.worn});
    }
    if (!rows.empty() && campaign.taken_J > rows.back().c_e_J) rows.push_back({campaign.taken_J});
    return rows;
}

}  // namespace

void check(const Campaign& campaign, unsigned first_line) {
    const std::vector<Point>& points = campaign.points;
    if (points.size() < 2)
        throw Error(campaign.source, 0, "", fmt::format("{}: a campaign needs at least two", points.empty() ? "no maneuver" : "one maneuver only"));
    for (std::size_t i = 0; i < points.size(); ++i) {
        check_point(campaign.source, first_line + static_cast<unsigned>(i), points[i], i == 0 ? std::nullopt : std::optional(points[i - 1].c_e_J));
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
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (csv.starts_with(kByteOrderMark)) csv.remove_prefix(kByteOrderMark.size());
    Parser parser(name);
    for (CsvRows rows(csv); rows.next();) parser.take(rows.line(), rows.fields());
    Campaign campaign = std::move(parser).campaign();
    campaign.origin = origin_of(name, csv);
    return campaign;
}

Campaign read_campaign(const std::filesystem::path& csv) {
    return parse_campaign(csv.string(), settings::read_file(csv));
}

double brake_energy_J(const Campaign& campaign, std::size_t i) {
    const std::vector<Point>& p = campaign.points;
    const auto landing = std::lower_bound(campaign.landings.begin(), campaign.landings.end(), p[i].c_e_J,
                                          [](const LandingEnergy& one, double c_e_J) { return one.c_e_J < c_e_J; });
    if (landing != campaign.landings.end() && landing->c_e_J == p[i].c_e_J) return landing->energy_J;
    if (i > 0) return p[i].c_e_J - p[i - 1].c_e_J;
    const double mean_step_J = (p.back().c_e_J - p.front().c_e_J) / static_cast<double>(p.size() - 1);
    return p[0].c_e_J <= 1.5 * mean_step_J ? p[0].c_e_J : std::numeric_limits<double>::quiet_NaN();
}

double taken_before_J(const Campaign& campaign) {
    const std::vector<Point>& p = campaign.points;
    if (const double first_J = brake_energy_J(campaign, 0); !std::isnan(first_J)) return std::max(0.0, p.front().c_e_J - first_J);
    return p.front().c_e_J - (p.back().c_e_J - p.front().c_e_J) / static_cast<double>(p.size() - 1);
}

double taken_now_J(const Campaign& campaign) {
    return std::max(campaign.points.back().c_e_J, campaign.taken_J);
}

std::string to_csv(const Campaign& campaign) {
    const bool brakings = !campaign.brakings.empty();
    const std::vector<Row> rows = rows_of(campaign);
    const bool outcomes = rows.size() > campaign.points.size();
    std::string csv = campaign.origin == kUnknownOrigin ? std::string() : fmt::format("{}{}\n", kOrigin, campaign.origin);
    csv += "maneuver,mean_friction,brake_energy_J,cumulative_energy_J";
    if (brakings) {
        for (const BrakingColumn& column : kBraking) csv.append(",").append(column.name);
    }
    for (const PartColumn& part : kPartColumns)
        if (!(campaign.*part.value).empty()) csv.append(",").append(part.name);
    if (!campaign.readings.empty()) csv.append(",").append(kLining);
    if (outcomes) csv.append(",").append(kOutcome);
    csv += "\n";
    for (const Row& row : rows) {
        csv += row.point ? fmt::format("{},{}", *row.point + 1, campaign.points[*row.point].mean_friction) : std::string(",");
        fmt::format_to(std::back_inserter(csv), ",{},{}", std::isnan(row.energy_J) ? std::string() : fmt::format("{}", row.energy_J), row.c_e_J);
        if (brakings) {
            for (const BrakingColumn& column : kBraking)
                csv += row.point ? fmt::format(",{}", campaign.brakings[*row.point].*column.value) : std::string(",");
        }
        for (const PartColumn& part : kPartColumns)
            if (!(campaign.*part.value).empty()) csv.append(",").append(settings::csv_field(campaign.*part.value));
        if (!campaign.readings.empty()) csv += row.worn ? fmt::format(",{}", *row.worn) : std::string(",");
        if (outcomes) csv.append(",").append(row.point ? kFinished : std::isnan(row.energy_J) ? kLeftOut : kOutOfTolerance);
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
