#include "plant_sim/campaign_source.hpp"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <string_view>
#include <vector>

#include "rig_bridge/record/ledger.hpp"

namespace plant_sim {

namespace {

bool is_sqlite(const std::filesystem::path& path) {
    constexpr std::string_view kMagic = "SQLite format 3";
    std::array<char, kMagic.size()> head{};
    std::ifstream file(path, std::ios::binary);
    return file.read(head.data(), head.size()) && std::string_view(head.data(), head.size()) == kMagic;
}

std::string chosen_campaign(const std::filesystem::path& ledger, const std::string& wanted) {
    if (!wanted.empty()) return wanted;
    const std::vector<rig::Campaign> all = rig::read_campaigns(ledger);
    if (all.size() == 1) return all.front().name;
    std::string names;
    for (const rig::Campaign& c : all) {
        names += names.empty() ? "" : ", ";
        names += c.name;
    }
    throw settings::Error(
        ledger.string(), 0, "",
        all.empty() ? std::string("no campaign in this ledger")
                    : fmt::format("holds {} campaigns; choose one with --campaign: {}", all.size(), names));
}

wear::Campaign from_ledger(const std::filesystem::path& ledger, const std::string& wanted) {
    const std::string name = chosen_campaign(ledger, wanted);
    wear::Campaign out;
    out.source = fmt::format("{}, campaign {}", ledger.string(), name);
    const std::vector<rig::LedgerRow> rows = rig::read_ledger(ledger, name);
    out.points.reserve(rows.size());
    for (const rig::LedgerRow& row : rows) {
        if (row.state == rig::RowState::finished)
            out.points.push_back({row.summary.cumulative_energy_J, row.summary.figures.mean_friction});
    }
    wear::check(out);
    return out;
}

}  // namespace

wear::Campaign load_campaign(const std::filesystem::path& where, const std::string& campaign) {
    const std::filesystem::path file = std::filesystem::is_directory(where) ? where / "ledger.sqlite" : where;
    if (is_sqlite(file)) return from_ledger(file, campaign);
    if (!campaign.empty())
        throw settings::Error(file.string(), 0, "", "--campaign is for ledgers; this file is none");
    return wear::read_campaign(file);
}

}  // namespace plant_sim
