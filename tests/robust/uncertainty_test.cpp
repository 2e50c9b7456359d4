/// Draws: within their ranges, of their family alone, and decided by seed and number.
#include "plant_sim/study/robust/uncertainty.hpp"

#include <fstream>
#include <set>
#include <sstream>

#include "firmware/host/settings/error.hpp"
#include "plant_sim/study/robust/robust_campaign.hpp"
#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"

using namespace robust;

namespace {

RobustPlan shipped() {
    return load_plan({});
}

bool within(double value, const Interval& range) {
    return value >= range.low && value <= range.high;
}

}  // namespace

TEST_CASE("a draw takes what its family says, within the ranges, and leaves the rest", "[STUDY-602]") {
    const RobustPlan plan = shipped();
    const Uncertainty& u = plan.basis.uncertainty;
    REQUIRE(plan.basis.landings.size() == 14);
    REQUIRE(plan.basis.surfaces.size() == 8);
    for (std::size_t f = 0; f < kDrawnFamilies; ++f) {
        const auto family = static_cast<Family>(f);
        int rings = 0;
        std::set<std::size_t> landings;
        for (std::size_t i = 0; i < 140; ++i) {
            const Draw d = draw(plan.basis, family, 1, i);
            landings.insert(d.landing);
            const rig::RigParameters& was = plan.basis.landings[d.landing].rig;
            const auto& [ring, relaxation, leg] = d.rig.wheel.compliance;
            INFO(name(family) << " " << i);
            const bool all = family == Family::all;
            rings += ring.belt_share > 0.0 ? 1 : 0;
            CHECK((ring.belt_share > 0.0 && relaxation.length_m > 0.0) == false);
            if (family == Family::ring || (all && ring.belt_share > 0.0)) {
                CHECK(within(ring.belt_share, u.belt_share));
                CHECK(within(ring.frequency_Hz, u.ring_Hz));
                CHECK(within(ring.damping, u.ring_damping));
            } else {
                CHECK(ring.belt_share == 0.0);
            }
            CHECK((relaxation.length_m > 0.0) == (family == Family::relaxation || (all && ring.belt_share == 0.0)));
            if (relaxation.length_m > 0.0) CHECK(within(relaxation.length_m, u.relaxation_m));
            CHECK((leg.mass_kg > 0.0) == (family == Family::leg || all));
            if (leg.mass_kg > 0.0) {
                CHECK(within(leg.mass_kg, u.leg_kg));
                CHECK(within(leg.frequency_Hz, u.leg_Hz));
                CHECK(within(leg.damping, u.leg_damping));
            }
            const bool changed = family == Family::parameters || all;
            CHECK((d.rig.valve.delay_s != was.valve.delay_s) == changed);
            CHECK(within(d.rig.wheel.inertia_kgm2 / was.wheel.inertia_kgm2, changed ? u.wheel_inertia : Interval{1, 1}));
            CHECK(within(d.rig.brake.gain_m3() / was.brake.gain_m3(),
                         changed ? Interval{u.brake_gain.low - 1e-9, u.brake_gain.high + 1e-9} : Interval{1, 1}));
            CHECK((d.rig.wheel_encoder.pitch_error > 0.0) == changed);
            CHECK(d.rig.runway.patches.empty() == !(family == Family::patches || all));
            CHECK(d.rig.surface.magic.has_value() == (family == Family::curves));
            if (family == Family::curves) {
                const rig::Peak peak = rig::peak(d.rig.surface);
                CHECK(within(peak.slip, u.curve_peak_slip));
                CHECK(peak.mu == Approx(rig::peak(was.surface).mu).epsilon(1e-12));
                CHECK(within(d.rig.surface.magic->C, u.curve_C));
                CHECK(within(d.rig.surface.magic->E, u.curve_E));
            }
            CHECK(d.rig.clamping.any() == (family == Family::brakes));
            CHECK((d.rig.friction_curve != was.friction_curve) == (family == Family::brakes));
            if (family == Family::brakes) {
                const auto& [contact_Pa, piston_friction, run_out, warp] = d.rig.clamping;
                CHECK(within(contact_Pa, u.contact_Pa));
                CHECK(within(piston_friction, u.piston_friction));
                CHECK(within(run_out, u.run_out));
                CHECK(within(warp, u.warp));
                const auto& c = d.rig.friction_curve;
                CHECK(c[0] + c[1] / 2.0 + c[2] / 3.0 == Approx(d.rig.mean_friction));
                // Before it is brought to its mean, which lies between the least and the greatest of the three.
                CHECK(rig::min_friction(c, d.rig.mean_friction) > 0.4 * d.rig.mean_friction);
            }
            CHECK((d.rig.brake_on_mps != was.brake_on_mps) == (family == Family::speed));
            if (family == Family::speed) CHECK(within(d.rig.brake_on_mps, u.speed_mps));
        }
        CHECK(landings.size() == 14);
        if (family == Family::all) CHECK((rings > 40 && rings < 100));
    }
}

TEST_CASE("seed and number decide a draw; another seed is another plant", "[STUDY-602]") {
    const RobustPlan plan = shipped();
    const auto ring_Hz = [&](std::uint64_t seed, std::size_t number) {
        return draw(plan.basis, Family::ring, seed, number).rig.wheel.compliance.ring.frequency_Hz;
    };
    CHECK(ring_Hz(1, 7) == ring_Hz(1, 7));
    CHECK(ring_Hz(1, 7) != ring_Hz(2, 7));
    CHECK(ring_Hz(1, 7) != ring_Hz(1, 8));
    double sum = 0.0;
    for (std::size_t i = 0; i < 2000; ++i) sum += ring_Hz(3, i);
    CHECK(sum / 2000.0 == Approx(85.0).margin(2.0));  // evenly from 50 to 120 Hz: standard error 0.45
    const Draw patched = draw(plan.basis, Family::patches, 1, 0);
    double before = 0.0;
    for (const rig::Patch& patch : patched.rig.runway.patches) {
        CHECK(within(patch.from_m - before, {15.0 - 1e-9, 400.0 + 1e-9}));
        before = patch.from_m;
    }
    CHECK(before >= 6000.0);
    CHECK_THAT(describe(plan.basis, patched), ContainsSubstring(" from "));
}

TEST_CASE("ranges that cannot be are refused with file, line and key", "[STUDY-602]") {
    std::ifstream file("config/uncertainty.toml");
    std::stringstream text;
    text << file.rdbuf();
    const auto rejected = [&](const std::string& before, const std::string& after, const std::string& says) {
        std::string changed = text.str();
        const auto at = changed.find(before);
        REQUIRE(at != std::string::npos);
        changed.replace(at, before.size(), after);
        const TemporaryDirectory directory;
        const auto path = directory / "u.toml";
        std::ofstream(path) << changed;
        try {
            static_cast<void>(load_uncertainty(path));
            FAIL("accepted " << after);
        } catch (const settings::Error& error) {
            CHECK_THAT(error.what(), ContainsSubstring(says));
            CHECK_THAT(error.what(), ContainsSubstring("u.toml"));
        }
    };
    rejected("delay_ms = [4.0, 10.0]", "delay_ms = [10.0, 4.0]", "the second number is below the first");
    rejected("delay_ms = [4.0, 10.0]", "delay_ms = [4.0]", "delay_ms");
    rejected("belt_share = [0.25, 0.45]", "belt_share = [0.25, 1.45]", "belt_share");
    rejected("[leg]", "[legs]", "leg");
    rejected("warp = [0.0, 0.03]", "warp = [0.0, 0.5]", "warp");
    rejected("[25.0, 40.0, 55.0]", "[25.0, 90.0]", "speed_mps");
    rejected("[12.0, 16.667,", "[16.667, 12.0,", "speed_mps");
    rejected("[patches]", "[patches]\nwidth_m = 3.0", "width_m");
}
