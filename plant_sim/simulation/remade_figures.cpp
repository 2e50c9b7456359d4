#include "plant_sim/simulation/remade_figures.hpp"

#include <fmt/format.h>

#include "plant_sim/simulation/campaign_books.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "rig_bridge/replay/log_meter.hpp"

namespace plant_sim::simulation {

std::vector<std::string> RemadeFigures::check(std::span<const rig::record::LedgerRow> rows) {
    std::vector<std::string> wrong;
    for (const rig::record::LedgerRow& row : rows) {
        if (row.state != rig::record::RowState::finished || !seen_.insert(row.attempt.folder).second) continue;
        const PassingFile file(disk_->bytes(row.attempt.folder / "bus.log"));
        rig::replay::LogWarnings warnings("bus.log", {});
        const rig::record::Figures made =
            rig::replay::meter_log(file.path(), setup_.layout, setup_.meter, rig::replay::LogEnd::closed, warnings).figures;
        const rig::record::Figures written = rig::record::read_summary(row.attempt.folder / "summary.json", *disk_).figures;
        for (const rig::record::FigureField& field : rig::record::kFigureFields)
            for (const auto& [where, figures] : {std::pair{"summary.json", &written}, std::pair{"the ledger", &row.summary.figures}})
                if (figures->*field.value != made.*field.value)
                    wrong.push_back(fmt::format("maneuver {}, attempt {}: {} has {} = {}, its recording says {}", row.attempt.number,
                                                row.attempt.attempt, where, field.key, figures->*field.value, made.*field.value));
    }
    return wrong;
}

}  // namespace plant_sim::simulation
