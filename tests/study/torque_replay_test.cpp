/// Recorded torque through the plant: closed forms for one stop, and Fig. 9's measures for a campaign.
#include "plant_sim/study/torque_replay.hpp"

#include <cmath>
#include <stdexcept>

#include "plant_sim/wear/resimulation.hpp"
#include "rig_bridge/wear/fit.hpp"
#include "tests/catch.hpp"
#include "tests/wear/physical_campaign.hpp"

namespace {

rig::LoadedRig bench(double friction = 0.30) {
    rig::ManeuverChoice choice;
    choice.maneuver = rig::kEndurance;
    rig::LoadedRig rig = rig::load_rig("config", choice);
    rig.rig.mean_friction = friction;
    return rig;
}

constexpr wear::Braking kTableThree{.brake_on_mps = 54.86, .mean_torque_Nm = 630.37, .mean_load_N = 23532.78};
/// m + J / r^2 and r under that load, by hand from flywheel_rig.toml.
constexpr double kMass_kg = 633.62 + 1.3 / 0.09;
constexpr double kRadius_m = 0.30;

/// A campaign of the physical law with what would have been recorded: speed from the energy, torque and load as printed.
wear::Campaign recorded(int maneuvers, std::uint64_t seed) {
    physical::BrakeLaw law = physical::shipped_law();
    law.lining_J = 0.975e6 * maneuvers;
    law.run_in_J = law.lining_J * 0.03;
    wear::Campaign out = physical::campaign(law, seed, nullptr, maneuvers);
    double before_J = 0.0;
    for (const wear::Point& p : out.points) {
        const double energy_J = p.c_e_J - before_J;
        before_J = p.c_e_J;
        out.brakings.push_back({std::sqrt(2.0 * energy_J / kMass_kg), 630.37, 23532.78});
    }
    return out;
}

}  // namespace

TEST_CASE("a torque that is held stops the flywheel as eq. (1) says, whatever the friction", "[RIG-200]") {
    for (const double friction : {0.30, 0.18}) {
        CAPTURE(friction);
        const study::TorqueStop stop = study::stop_by_torque(bench(friction), kTableThree);
        CHECK_FALSE(stop.short_of_pressure);
        // (m + J / r^2) r a = T; the wheel slips by half a percent.
        const double a_mps2 = kTableThree.mean_torque_Nm / (kMass_kg * kRadius_m);
        CHECK(stop.duration_s == Approx(kTableThree.brake_on_mps / a_mps2).epsilon(0.005));
        CHECK(stop.length_m == Approx(0.5 * kTableThree.brake_on_mps * kTableThree.brake_on_mps / a_mps2).epsilon(0.005));
        CHECK(stop.energy_brake_J == Approx(0.5 * kMass_kg * kTableThree.brake_on_mps * kTableThree.brake_on_mps).epsilon(0.01));
        // At constant torque eq. (7) is the harmonic mean of the light curve over time, which at constant deceleration is over speed, down
        // to drop-out: below the brake's mean.
        constexpr int kParts = 1000;
        double inverse = 0.0;
        for (int i = 0; i < kParts; ++i) {
            const double x = 5.0 / 54.86 + (1.0 - 5.0 / 54.86) * (i + 0.5) / kParts;
            inverse += 1.0 / (friction + 0.30 * (0.10 - 0.16 * x - 0.06 * x * x)) / kParts;
        }
        CHECK(stop.mean_friction == Approx(1.0 / inverse).epsilon(0.002));
    }
}

TEST_CASE("a brake too worn for the torque gives what full pressure gives", "[RIG-200]") {
    // Table III's torque at full pressure is friction 0.137; at brake-on the light curve lies 0.036 below its mean.
    const study::TorqueStop worn = study::stop_by_torque(bench(0.15), kTableThree);
    CHECK(worn.short_of_pressure);
    CHECK(worn.duration_s > study::stop_by_torque(bench(0.20), kTableThree).duration_s);
    CHECK_FALSE(study::stop_by_torque(bench(0.18), kTableThree).short_of_pressure);
    CHECK_THROWS_AS(study::stop_by_torque(bench(), {.brake_on_mps = 0.0}), std::invalid_argument);
}

TEST_CASE("Fig. 9 through the plant: energy is the recorded, friction has the recorded trend and scatter", "[RIG-300]") {
    const wear::Campaign campaign = recorded(200, 41);
    wear::FitSettings settings;
    settings.max_components = 8;
    settings.starts = 5;
    const auto model = std::make_shared<const wear::Model>(wear::model_of(campaign, wear::fit(campaign, settings), settings));
    constexpr wear::ConditionalRule kRule{wear::Variance::exact, wear::Choice::mixture};
    const wear::WearingBrake brake({model, {}, 195e6, {}}, kRule, {.seed = 2});
    std::size_t calls = 0;
    const study::TorqueReplay replay = study::replay_torques(campaign, bench(), brake, [&](std::size_t done) { CHECK(done == ++calls); });
    REQUIRE(replay.simulated.points.size() == 200);
    CHECK(calls == 200);
    CHECK(replay.short_of_pressure == 0);
    CHECK(std::abs(replay.energy_error) < 0.01);
    const wear::Comparison c = wear::compare(campaign, replay.simulated, *model, kRule);
    double off = 0.0;
    double variance = 0.0;
    for (const wear::EnergyBand& band : c.bands) {
        CAPTURE(band.from_J, band.mean_error, band.deviation_recorded, band.deviation_simulated);
        // Four standard errors of the difference of two means.
        const double error = std::hypot(band.deviation_recorded, band.deviation_simulated) / std::sqrt(static_cast<double>(band.maneuvers));
        CHECK(std::abs(band.mean_error) < 4.0 * error);
        off += band.mean_error;
        variance += error * error;
    }
    // Readings drawn as readings: taken as means of the curve they would come out 1 to 3 % low, 5 standard errors.
    CAPTURE(off);
    CHECK(std::abs(off) < 4.0 * std::sqrt(variance));
    CHECK(c.ks_probability > 0.001);
    // Friction is asked at the energy that the plant came to: of another brake it would be another.
    wear::Campaign without = campaign;
    without.brakings.clear();
    CHECK_THROWS_AS(study::replay_torques(without, bench(), brake), std::invalid_argument);
}
