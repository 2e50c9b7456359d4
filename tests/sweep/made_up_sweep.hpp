/// Sweeps with figures in closed form.
#pragma once

#include "plant_sim/study/sweep/stops_table.hpp"

namespace made_up {

/// `figures(reference, landing)` for every stop; reference 0 is the threshold law.
template <typename Figures>
sweep::StopsTable table(std::vector<double> references, std::size_t landings, const Figures& figures, bool threshold = true) {
    sweep::StopsTable t{.name = "made up"};
    t.identity = {.version = "1", .config_hash = "h", .seed = 1, .references = std::move(references), .landings = landings, .threshold = threshold};
    for (std::size_t i = 0; i < t.identity.stops(); ++i) {
        const std::size_t r = i / landings;
        sweep::SweptStop row;
        row.stop.number = i;
        row.stop.landing = i % landings;
        row.stop.threshold = r == t.identity.references.size();
        row.stop.slip_reference = row.stop.threshold ? 0.0 : t.identity.references[r];
        row.figures = figures(row.stop.slip_reference, row.stop.landing);
        row.figures.standstill = true;
        t.rows.push_back(row);
    }
    return t;
}

/// What the paper says, as formulas: best at 0.22, energy shared in the ratio of the slip.
inline study::StopFigures like_the_paper(double reference, std::size_t landing) {
    study::StopFigures f;
    const double slip = reference > 0.0 ? reference : 0.16;
    const double below = slip < 0.22 ? 0.22 - slip : 0.0;
    const double above = slip > 0.22 ? slip - 0.22 : 0.0;
    const double size = 1.0 + 0.5 * static_cast<double>(landing % 3);
    f.j_mu = (reference > 0.0 ? 0.966 : 0.93) - 7.0 * below * below - 1.5 * above * above;
    f.stop_distance_m = 480.0 / f.j_mu;
    f.energy_brake_J = 4e6 * size * (1.0 - slip);
    f.energy_tyre_J = 4e6 * size * slip;
    f.tracked_share = 1.0;
    f.tracked_tyre_share = slip;
    return f;
}

}  // namespace made_up
