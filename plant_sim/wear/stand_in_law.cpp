#include "plant_sim/wear/stand_in_law.hpp"

#include <algorithm>
#include <cmath>

namespace wear {

double StandInLaw::mean_friction(double E, double draw) const {
    const StandInParameters& p = parameters_;
    const double expected = p.friction + p.bedding_in * std::exp(-E / p.bedding_in_J) -
                            p.slow_loss * E / p.life_J - p.wear_out * std::exp((E - p.life_J) / p.wear_out_J);
    return std::max(p.least, expected + p.deviation * draw);
}

}  // namespace wear
