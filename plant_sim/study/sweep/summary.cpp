#include "plant_sim/study/sweep/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"

namespace sweep {

namespace {

constexpr double kTracked = 0.95;

Means means_of(std::span<const SweptStop> rows) {
    Means m{.slip_reference = rows.front().stop.slip_reference, .landings = rows.size(), .min_j_mu = 1.0};
    const auto n = static_cast<double>(rows.size());
    for (const SweptStop& row : rows) {
        const study::StopFigures& f = row.figures;
        m.j_mu += f.j_mu / n;
        m.min_j_mu = std::min(m.min_j_mu, f.j_mu);
        m.stop_distance_m += f.stop_distance_m / n;
        m.energy_brake_J += f.energy_brake_J / n;
        m.energy_tyre_J += f.energy_tyre_J / n;
        m.slip_efficiency += f.slip_efficiency / n;
        m.longest_lock_s = std::max(m.longest_lock_s, f.longest_lock_s);
        m.lock_s += f.longest_lock_s / n;
        if (!row.faults.empty()) ++m.faults;
        if (!f.standstill) ++m.not_at_rest;
        if (!row.stop.threshold && f.tracked_share >= kTracked && f.tracked_tyre_share) {
            ++m.tracked_landings;
            m.tracked_tyre_share += *f.tracked_tyre_share;
        }
    }
    m.tyre_share = m.energy_tyre_J / (m.energy_brake_J + m.energy_tyre_J);
    if (m.tracked_landings > 0) m.tracked_tyre_share /= static_cast<double>(m.tracked_landings);
    double squares = 0.0;
    for (const SweptStop& row : rows) squares += (row.figures.j_mu - m.j_mu) * (row.figures.j_mu - m.j_mu);
    if (rows.size() > 1) m.j_mu_error = std::sqrt(squares / (n - 1.0) / n);
    return m;
}

settings::Json json_of(const Means& m) {
    settings::Json json;
    if (m.slip_reference > 0.0) json["slip_reference"] = m.slip_reference;
    json.update({{"landings", m.landings},
                 {"j_mu", m.j_mu},
                 {"j_mu_error", m.j_mu_error},
                 {"min_j_mu", m.min_j_mu},
                 {"stop_distance_m", m.stop_distance_m},
                 {"energy_brake_J", m.energy_brake_J},
                 {"energy_tyre_J", m.energy_tyre_J},
                 {"tyre_share", m.tyre_share},
                 {"slip_efficiency", m.slip_efficiency}});
    if (m.slip_reference > 0.0) json.update({{"tracked_landings", m.tracked_landings}, {"tracked_tyre_share", m.tracked_tyre_share}});
    json.update({{"longest_lock_s", m.longest_lock_s}, {"lock_s", m.lock_s}, {"stops_with_faults", m.faults}, {"stops_not_at_rest", m.not_at_rest}});
    return json;
}

}  // namespace

bool Summary::passed() const {
    return std::all_of(checks.begin(), checks.end(), [](const Check& check) { return check.passed; });
}

Summary summarised(const Identity& identity, std::span<const SweptStop> rows) {
    Summary s{.identity = identity};
    s.references.reserve(identity.references.size());
    for (std::size_t i = 0; i < identity.references.size(); ++i)
        s.references.push_back(means_of(rows.subspan(i * identity.landings, identity.landings)));
    if (identity.threshold) s.threshold = means_of(rows.last(identity.landings));
    for (std::size_t i = 0; i < s.references.size(); ++i) {
        if (s.references[i].j_mu > s.references[s.best].j_mu) s.best = i;
    }
    check(s);
    return s;
}

std::string to_json(const Summary& s) {
    settings::Json references = settings::Json::array();
    for (const Means& m : s.references) references.push_back(json_of(m));
    settings::Json checks = settings::Json::array();
    for (const Check& c : s.checks) checks.push_back({{"name", c.name}, {"demand", c.demand}, {"measured", c.measured}, {"passed", c.passed}});
    settings::Json json{{"study", "sweep"},        {"version", s.identity.version},   {"config_hash", s.identity.config_hash},
                        {"seed", s.identity.seed}, {"landings", s.identity.landings}, {"stops", s.identity.stops()}};
    if (!s.references.empty()) json["best"] = {{"slip_reference", s.references[s.best].slip_reference}, {"j_mu", s.references[s.best].j_mu}};
    json["references"] = references;
    if (s.threshold) json["threshold"] = json_of(*s.threshold);
    json["checks"] = checks;
    json["unchecked"] = s.unchecked;
    json["passed"] = s.passed();
    return settings::json_page(json);
}

std::string to_table(const Summary& s) {
    auto table = settings::TextTable::screen(
        "reference:>10|J_mu:>9.4f|distance_m:>11.1f|brake_MJ:>11.3f|tyre_MJ:>10.3f|share:>9.3f|efficiency:>11.3f|lock_ms:>10.0f");
    const auto add = [&table](const std::string& name, const Means& m) {
        table.add(name, m.j_mu, m.stop_distance_m, m.energy_brake_J * 1e-6, m.energy_tyre_J * 1e-6, m.tyre_share, m.slip_efficiency,
                  m.longest_lock_s * 1e3);
    };
    constexpr std::size_t kFew = 12;
    for (std::size_t i = 0; i < s.references.size(); ++i) {
        const double reference = s.references[i].slip_reference;
        const bool fifth = std::lround(reference * 100.0) % 5 == 0;
        const bool end = i == 0 || i + 1 == s.references.size();
        if (s.references.size() <= kFew || fifth || end || i == s.best || reference == kPaperReference)
            add(fmt::format("{:.2f}{}", reference, i == s.best ? " *" : "  "), s.references[i]);
    }
    if (s.threshold) add("threshold", *s.threshold);
    table.line("* greatest mean J_mu. share: the tyre's, of the energy of both.");
    for (const Check& c : s.checks) table.line(fmt::format("{}  {}: {}", c.passed ? "ok    " : "FAILED", c.demand, c.measured));
    for (const std::string& demand : s.unchecked) table.line(fmt::format("--      {}: not judged with so few references or landings", demand));
    return fmt::format("{} stops: {} slip references x {} landings{}\n{}", s.identity.stops(), s.references.size(), s.identity.landings,
                       s.threshold ? ", and the same landings by the threshold law" : "", table.text());
}

}  // namespace sweep
