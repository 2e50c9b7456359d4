/// What a held reference offers, against closed forms and an integration over time.
#include "plant_sim/study/robust/held_reference.hpp"

#include <cmath>

#include "plant_sim/study/robust/robust_campaign.hpp"
#include "tests/catch.hpp"

using robust::held_j_mu;

namespace {

robust::RobustPlan as_configured() {
    return robust::load_plan({});
}

/// Of the friction curve, eq. (4), written out.
double mu(const rig::Surface& s, double slip) {
    return s.c1 * (1.0 - std::exp(-s.c2 * slip)) - s.c3 * slip;
}

}  // namespace

TEST_CASE("without a fall at low speed it is the curve's own ratio; at the peak all of it", "[STUDY-602]") {
    const robust::RobustPlan plan = as_configured();
    antiskid::control::SlipConfig config = plan.controller.slip;
    config.low_speed_mps = 0.0F;
    for (const robust::NominalLanding& landing : plan.basis.landings) {
        const rig::Surface& s = landing.rig.surface;
        const double peak = std::log(s.c1 * s.c2 / s.c3) / s.c2;
        CHECK(held_j_mu(landing.rig, config, 0.24, 5.0) == Approx(mu(s, 0.24) / mu(s, peak)).epsilon(1e-6));
        CHECK(held_j_mu(landing.rig, config, peak, 5.0) == Approx(1.0).epsilon(1e-6));
    }
}

TEST_CASE("with the fall it is what an integration over time gives", "[STUDY-602]") {
    const robust::RobustPlan plan = as_configured();
    const antiskid::control::SlipConfig& c = plan.controller.slip;
    const double from = static_cast<double>(c.low_speed_mps), to = static_cast<double>(c.low_speed_floor_mps),
                 low = static_cast<double>(c.low_speed_slip);
    REQUIRE(from > to);
    for (const robust::NominalLanding& landing : plan.basis.landings) {
        for (const double brake_on_mps : {12.0, 20.0, 61.0}) {
            rig::RigParameters rig = landing.rig;
            rig.brake_on_mps = brake_on_mps;
            const rig::Surface& s = rig.surface;
            const double peak = std::log(s.c1 * s.c2 / s.c3) / s.c2;
            double v = brake_on_mps, had = 0.0, max = 0.0;
            constexpr double kStep_s = 1e-4;
            while (v > 5.0) {
                double slip = 0.24;
                if (v < from) slip = v < to ? low : low + (0.24 - low) * (v - to) / (from - to);
                had += mu(s, slip) * v * kStep_s;
                max += mu(s, peak) * v * kStep_s;
                v -= mu(s, slip) * (rig.load.base_N - rig.load.lift_Ns2pm2 * v * v) / rig.wheel.mass_kg * kStep_s;
            }
            INFO(landing.surface << " " << landing.maneuver << " " << brake_on_mps);
            CHECK(held_j_mu(rig, c, 0.24, 5.0) == Approx(had / max).epsilon(2e-4));
        }
    }
}
