#include "plant_sim/simulation/recomputed_figures.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/record/summary_file.hpp"
#include "rig_bridge/replay/log_meter.hpp"

namespace plant_sim::simulation {

std::vector<std::string> RecomputedFigures::check(std::span<const rig::record::LedgerRow> rows) {
    std::vector<std::string> wrong;
    for (const rig::record::LedgerRow& row : rows) {
        if (row.state != rig::record::RowState::finished || !seen_.insert(row.attempt.folder).second) continue;
        const rig::replay::LogText log{disk_->bytes(row.attempt.folder / "bus.log")};
        rig::replay::LogWarnings warnings("bus.log", {});
        const rig::replay::MeteredLog made = rig::replay::meter_log(log, setup_.layout, setup_.meter, warnings);
        const rig::record::Summary written = rig::record::read_summary(row.attempt.folder / "summary.json", *disk_);
        const std::string what = fmt::format("maneuver {}, attempt {}", row.attempt.number, row.attempt.attempt);
        for (const rig::record::FigureField& field : rig::record::kFigureFields)
            for (const auto& [where, figures] : {std::pair{"summary.json", &written.figures}, std::pair{"the ledger", &row.summary.figures}})
                if (figures->*field.value != made.figures.*field.value)
                    wrong.push_back(fmt::format("{}: {} has {} = {}, its recording says {}", what, where, field.key, figures->*field.value,
                                                made.figures.*field.value));
        if (written.warnings != made.warnings)
            wrong.push_back(fmt::format("{}: summary.json warns of '{}', its recording of '{}'", what, fmt::join(written.warnings, "; "),
                                        fmt::join(made.warnings, "; ")));
    }
    return wrong;
}

}  // namespace plant_sim::simulation
