#include "rig_bridge/replay/campaign_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string_view>
#include <vector>

#include "firmware/host/settings/error.hpp"

namespace rig::replay {

using record::LedgerRow;

namespace {

bool is_sqlite(const std::filesystem::path& path) {
    constexpr std::string_view kMagic = "SQLite format 3";
    std::array<char, kMagic.size()> head{};
    std::ifstream file(path, std::ios::binary);
    return file.read(head.data(), head.size()) && std::string_view(head.data(), head.size()) == kMagic;
}

wear::Campaign from_ledger(const std::filesystem::path& ledger, const std::string& wanted, OutOfTolerance off) {
    const std::string name = chosen_campaign(ledger, wanted);
    wear::Campaign out = wear_of(record::read_ledger(ledger, name), off);
    out.source = fmt::format("{}, campaign {}{}", ledger.string(), name, out.source);
    wear::check(out);
    return out;
}

std::filesystem::path ledger_in(const std::filesystem::path& directory) {
    return directory / "campaign.sqlite";
}

}  // namespace

std::filesystem::path ledger_at(const std::filesystem::path& where) {
    return std::filesystem::is_directory(where) ? ledger_in(where) : where;
}

std::string chosen_campaign(const std::filesystem::path& ledger, const std::string& wanted) {
    const std::vector<record::Campaign> all = record::read_campaigns(ledger);  // in any case: opening a ledger for writing creates a missing one
    if (!wanted.empty()) return wanted;
    if (all.size() == 1) return all.front().name;
    std::string names;
    for (const record::Campaign& c : all) {
        names += names.empty() ? "" : ", ";
        names += c.name;
    }
    throw settings::Error(ledger.string(), 0, "",
                          all.empty() ? std::string("no campaign in this ledger")
                                      : fmt::format("holds {} campaigns; choose one with --campaign: {}", all.size(), names));
}

wear::Campaign wear_of(const std::vector<LedgerRow>& rows, OutOfTolerance off) {
    wear::Campaign out;
    out.points.reserve(rows.size());
    out.brakings.reserve(rows.size());
    std::size_t left_out = 0, of_others = 0, unbalanced = 0, without_energy = 0;
    bool other_disc = false;  // has worn the same lining
    record::DiscEnergy taken;
    double cumulative_J = 0.0;  // after an attempt without a record, less than one maneuver more
    if (!rows.empty()) {
        out.brake = rows.back().summary.specimen.brake;
        out.disc = rows.back().summary.specimen.disc;
    }
    for (const LedgerRow& row : rows) {
        const record::Specimen& parts = row.summary.specimen;
        other_disc = other_disc || (parts.brake == out.brake && parts.disc != out.disc);
        const bool mine = parts.brake == out.brake && parts.disc == out.disc;
        cumulative_J = row.has_figures ? row.summary.cumulative_energy_J : cumulative_J + row.counted_J;
        const double disc_J = taken.after(parts, cumulative_J), own_J = disc_J - out.taken_J;
        if (mine) out.taken_J = disc_J;
        if (disc_J > 0.0 && std::isfinite(row.worn.lining) && mine) out.readings.push_back({disc_J, row.worn.lining});
        if (row.state != record::RowState::finished) continue;
        const bool doubtful = record::unbalanced(row.summary) && row.amendments.empty();
        constexpr double kRounded = 1e-9;  // of sums that were amended
        const bool adds = own_J > kRounded * disc_J;
        if (mine && adds && !doubtful) out.landings.push_back({disc_J, own_J});
        if (off == OutOfTolerance::left_out && record::off_conditions(row.summary)) {
            ++left_out;
            continue;
        }
        if (!mine) {
            ++of_others;
            continue;
        }
        if (doubtful) {
            ++unbalanced;
            continue;
        }
        if (!adds) {
            ++without_energy;
            continue;
        }
        const record::Figures& f = row.summary.figures;
        out.points.push_back({disc_J, f.mean_friction});
        out.brakings.push_back({f.brake_on_mps, f.mean_torque_Nm, f.mean_load_N});
    }
    if (left_out > 0) out.source += fmt::format(" ({} out of tolerance left out, --out-of-tolerance takes them)", left_out);
    if (unbalanced > 0) out.source += fmt::format(" ({} unbalanced left out, until amended)", unbalanced);
    if (without_energy > 0) out.source += fmt::format(" ({} that add no energy left out)", without_energy);
    if (of_others > 0) out.source += fmt::format(" (brake '{}', disc '{}'; {} maneuvers of others left out)", out.brake, out.disc, of_others);
    if (other_disc && !out.readings.empty()) {
        out.source += " (readings of the lining left out: another disc has worn it, too)";
        out.readings.clear();
    }
    return out;
}

wear::Campaign load_campaign(const std::filesystem::path& where, const std::string& campaign, OutOfTolerance off) {
    const std::filesystem::path file = ledger_at(where);
    if (is_sqlite(file)) return from_ledger(file, campaign, off);
    if (!campaign.empty()) throw settings::Error(file.string(), 0, "", "--campaign is for ledgers; this file is none");
    return wear::read_campaign(file);
}

std::vector<wear::Campaign> load_campaigns(const std::vector<std::filesystem::path>& sources, OutOfTolerance off) {
    std::vector<std::filesystem::path> files;
    for (const std::filesystem::path& source : sources) {
        if (!std::filesystem::is_directory(source) || std::filesystem::exists(ledger_in(source))) {
            files.push_back(source);
            continue;
        }
        const std::size_t before = files.size();
        for (const auto& entry : std::filesystem::directory_iterator(source))
            if (entry.path().extension() == ".csv") files.push_back(entry.path());
        if (files.size() == before) throw settings::Error(source.string(), 0, "", "neither a ledger nor a *.csv in this directory");
        std::sort(files.begin() + static_cast<std::ptrdiff_t>(before), files.end());
    }
    std::vector<wear::Campaign> campaigns;
    campaigns.reserve(files.size());
    for (const std::filesystem::path& file : files) campaigns.push_back(load_campaign(file, "", off));
    return campaigns;
}

}  // namespace rig::replay
