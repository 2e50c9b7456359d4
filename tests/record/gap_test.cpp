// Gaps of the record: what the meter makes of the speeds on both sides. Flywheel and wheel move in closed form. Where load cells are silent, all of
// the brake's energy is that of the speeds.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "rig_bridge/record/meter.hpp"
#include "tests/catch.hpp"
#include "tests/record/closed_form.hpp"

using namespace record_test;
using rig::record::Meter;
using rig::record::MeterSample;
using rig::record::ShaftSample;

namespace {

constexpr double kLoad_N = 23'532.0;
constexpr double kBrakeOn_s = 1.0;
constexpr std::uint8_t kSettling = 3, kBraking = 4, kAborting = 9;

/// From a time on the rim has this deceleration and the wheel this slip.
struct Piece {
    double from_s = 0.0, deceleration_mps2 = 0.0, slip = 0.0;
};

class Motion {
  public:
    explicit Motion(double v0_mps, std::vector<Piece> pieces) : v0_mps_(v0_mps), pieces_(std::move(pieces)) {}

    struct At {
        double v_mps = 0.0, omega_radps = 0.0, metres = 0.0, angle = 0.0;
        double rim_J = 0.0, rolling_J = 0.0;  ///< lost by the flywheel, and of it what the brake took by slip
    };
    [[nodiscard]] At at(double t) const {
        const double radius = kRig.wheel_radius_m - kLoad_N / kRig.wheel_stiffness_Npm;
        At at{.v_mps = v0_mps_};
        for (std::size_t i = 0; i < pieces_.size() && pieces_[i].from_s <= t; ++i) {
            const Piece& p = pieces_[i];
            const double h = (i + 1 < pieces_.size() ? std::min(t, pieces_[i + 1].from_s) : t) - p.from_s;
            const double metres = (at.v_mps - 0.5 * p.deceleration_mps2 * h) * h;
            const double lost_J = kRig.flywheel_mass_kg * p.deceleration_mps2 * metres;
            at.v_mps -= p.deceleration_mps2 * h;
            at.omega_radps = (1.0 - p.slip) * at.v_mps / radius;
            at.metres += metres;
            at.angle += (1.0 - p.slip) * metres / radius;
            at.rim_J += lost_J;
            at.rolling_J += (1.0 - p.slip) * lost_J;
        }
        return at;
    }
    /// With what the wheel itself gives.
    [[nodiscard]] double brake_J(double t) const {
        const double before = at(0.0).omega_radps, now = at(t).omega_radps;
        return at(t).rolling_J + 0.5 * kRig.wheel_inertia_kgm2 * (before * before - now * now);
    }

  private:
    double v0_mps_;
    std::vector<Piece> pieces_;
};

/// Way in edges of `pitch`: how many, and when the last one was.
template <typename Way>
ShaftSample edges(double t, double pitch, const Way& way) {
    const double count = std::floor(way(t) / pitch);
    double before = 0.0, after = t;
    for (int i = 0; i < 50; ++i) {
        const double mid = 0.5 * (before + after);
        (way(mid) < count * pitch ? before : after) = mid;
    }
    return {.edge_count = static_cast<std::uint32_t>(count) + 100, .edge_time = Time{std::llround(after * 1e9)}};
}

/// A time in which frames are missing. Nothing at all: the record leaps.
struct Gap {
    double from_s = 0.0, to_s = 0.0;
    bool wheel = true, flywheel = true, leaps = false;
};

struct Record {
    std::vector<Gap> gaps{};
    int every = 1, flywheel_at = 0;  ///< frames come each so many samples, the flywheel's so many after the wheel's
    double abort_s = 1e9, released_s = 1e9;
    std::function<double(double t)> cells{};  ///< torque as the cells have it; none: they are silent
    double age_s = 0.0;
    double pressure_Pa = 2e6, later_Pa = 2e6, changes_s = 0.0;
};

/// At `end_s`.
Meter metered(const Motion& motion, const Record& record, double end_s) {
    Meter meter(gated());
    MeterSample sample;
    sample.vertical_N = kLoad_N;
    sample.load_cells_reported = false;
    for (int n = 1; 1e-3 * n < end_s + 5e-4; ++n) {
        const double t = 1e-3 * n;
        bool wheel = true, flywheel = true, leaps = false;
        for (const Gap& gap : record.gaps) {
            if (t <= gap.from_s || t > gap.to_s) continue;
            wheel = wheel && !gap.wheel;
            flywheel = flywheel && !gap.flywheel;
            leaps = leaps || gap.leaps;
        }
        if (leaps) continue;
        wheel = wheel && n % record.every == 0;
        flywheel = flywheel && n % record.every == record.flywheel_at;
        constexpr double kPitch = 2.0 * std::numbers::pi / 60.0;
        if (wheel) sample.wheel = edges(t, kPitch, [&](double at) { return motion.at(at).angle; });
        if (flywheel) sample.flywheel = edges(t, kPitch * kRig.flywheel_radius_m, [&](double at) { return motion.at(at).metres; });
        sample.wheel.reported = wheel;
        sample.flywheel.reported = flywheel;
        sample.time_s = t;
        sample.phase = t < kBrakeOn_s ? kSettling : t < record.abort_s ? kBraking : kAborting;
        sample.pressure_Pa = t > record.released_s ? 0.0 : t < record.changes_s ? record.pressure_Pa : record.later_Pa;
        if (record.cells) {
            sample.load_cells_reported = n % 10 == 0;
            if (sample.load_cells_reported) sample.brake_torque_Nm = record.cells(t) + 1e-6 * n;  // none says the same twice
            sample.load_cells_age_s = record.age_s;
        }
        meter.feed(sample);
    }
    return meter;
}

/// "... may have taken up to 0.481 MJ that are in no record"; 0 without.
double unknown_J(const Meter& meter) {
    for (const std::string& warning : meter.warnings()) {
        const auto at = warning.find("up to ");
        double MJ = 0.0;
        if (at != std::string::npos && std::sscanf(warning.c_str() + at, "up to %lg MJ that are in no record", &MJ) == 1) return 1e6 * MJ;
    }
    return 0.0;
}

const std::vector<Gap> kAnyGap{{.from_s = 2.0, .to_s = 2.4}, {.from_s = 2.0, .to_s = 2.4, .leaps = true}};

}  // namespace

TEST_CASE("the slip of a gap is that of its own ways, also of a wheel that is held in it", "[BRG-200]") {
    for (const double slip : {0.03, 0.5, 0.9, 1.0}) {
        for (const Gap& gap : kAnyGap) {
            CAPTURE(slip, gap.leaps);
            const Motion motion(25.0, {{}, {.from_s = kBrakeOn_s, .deceleration_mps2 = 6.0, .slip = 0.03}, {2.0, 6.0, slip}});
            // What the gap says goes on.
            for (const double end_s : {2.45, 2.6, 2.8})
                CHECK(metered(motion, {.gaps = {gap}}, end_s).figures().energy_brake_J == Approx(motion.brake_J(end_s)).epsilon(0.02));
        }
    }
}

TEST_CASE("a gap is from where both shafts were reported to where both are", "[BRG-200]") {
    const Motion motion(25.0, {{}, {.from_s = kBrakeOn_s, .deceleration_mps2 = 6.0, .slip = 0.2}});
    // One goes on for 0.2 s, or is back as much earlier.
    for (const auto& [wheel, flywheel] :
         {std::pair{Gap{2.2, 2.8, true, false}, Gap{2.0, 2.6, false, true}}, std::pair{Gap{2.0, 2.6, true, false}, Gap{2.2, 2.8, false, true}},
          std::pair{Gap{2.0, 2.8, true, false}, Gap{2.2, 2.6, false, true}}, std::pair{Gap{2.2, 2.6, true, false}, Gap{2.0, 2.8, false, true}}}) {
        CAPTURE(wheel.from_s, wheel.to_s);
        CHECK(metered(motion, {.gaps = {wheel, flywheel}}, 3.0).figures().energy_brake_J == Approx(motion.brake_J(3.0)).epsilon(0.01));
    }
}

TEST_CASE("frames of both shafts need not come in the same sample", "[BRG-200]") {
    const Motion motion(25.0, {{}, {.from_s = kBrakeOn_s, .deceleration_mps2 = 6.0, .slip = 0.03}, {2.0, 6.0, 0.3}});
    for (const int every : {1, 2, 10}) {
        CAPTURE(every);
        CHECK(metered(motion, {.gaps = {}, .every = every, .flywheel_at = every / 2}, 3.0).figures().energy_brake_J ==
              Approx(motion.brake_J(3.0)).epsilon(0.01));
    }
}

TEST_CASE("speeds count again when their windows lie after the gap", "[BRG-200]") {
    // The wheel locks in the gap, or just before it: the first speeds after it are means over it, the wheel's longer than the flywheel's.
    for (const double locks_s : {1.99, 2.1, 2.25}) {
        for (const Gap& gap : kAnyGap) {
            CAPTURE(locks_s, gap.leaps);
            const Motion motion(25.0, {{}, {.from_s = kBrakeOn_s, .deceleration_mps2 = 6.0, .slip = 0.03}, {locks_s, 6.0, 1.0}});
            for (const double end_s : {2.5, 2.8})
                CHECK(metered(motion, {.gaps = {gap}}, end_s).figures().energy_brake_J == Approx(motion.brake_J(end_s)).epsilon(0.02));
        }
    }
}

TEST_CASE("friction leaves out where the record leaps, and goes on behind it", "[BRG-200]") {
    // What the brake did in the leap has a torque of its own, and the pressure of it is unknown.
    const Motion motion(40.0, {{}, {.from_s = kBrakeOn_s, .deceleration_mps2 = 3.0, .slip = 0.03}, {2.0, 9.0, 0.03}, {3.0, 3.0, 0.03}});
    const auto torque = [](double t) { return t < kBrakeOn_s ? 0.0 : 600.0; };
    const Record sound{.gaps = {}, .cells = torque, .later_Pa = 4e6, .changes_s = 2.5};
    Record leaps = sound;
    leaps.gaps = {{.from_s = 2.0, .to_s = 3.0, .leaps = true}};
    const auto friction = [](double braked_s, double pressure_Pas) { return 600.0 * braked_s / pressure_Pas / kRig.brake_gain_m3; };
    CHECK(metered(motion, sound, 4.0).figures().mean_friction == Approx(friction(3.0, 2e6 * 1.5 + 4e6 * 1.5)).epsilon(0.02));
    CHECK(metered(motion, leaps, 4.0).figures().mean_friction == Approx(friction(2.0, 2e6 + 4e6)).epsilon(0.03));
}

TEST_CASE("what the brake takes while the record leaps after an abort counts when the speeds are known again", "[BRG-200]") {
    constexpr double kReleased_s = 2.3;
    const Motion motion(25.0, {{}, {.from_s = kBrakeOn_s, .deceleration_mps2 = 6.0, .slip = 0.05}, {kReleased_s, 0.0, 0.0}});
    for (const double abort_s : {1.9, 2.2}) {
        CAPTURE(abort_s);
        const Meter meter =
            metered(motion, {.gaps = {{.from_s = 2.0, .to_s = 2.6, .leaps = true}}, .abort_s = abort_s, .released_s = kReleased_s}, 3.0);
        CHECK_FALSE(meter.open());
        CHECK(meter.figures().energy_brake_J == Approx(motion.brake_J(3.0)).epsilon(0.02));
    }
}

TEST_CASE("of a wheel that left the rim unheard after an abort, what its way does not say is in no record", "[BRG-200][BRG-261]") {
    constexpr double kAbort_s = 2.1, kLeaves_s = 2.2, kHeard_s = 2.6, kSettled_s = 2.66, kEnd_s = 3.0;
    const Motion off(25.0, {{}, {.from_s = kBrakeOn_s, .deceleration_mps2 = 6.0, .slip = 0.1}, {kLeaves_s, 0.0, 1.0}});
    const Motion on(25.0, {{}, {.from_s = kBrakeOn_s, .deceleration_mps2 = 6.0, .slip = 0.1}, {kLeaves_s, 0.0, 0.0}});
    const Motion slower(25.0, {{}, {.from_s = kBrakeOn_s, .deceleration_mps2 = 6.0, .slip = 0.1}, {kLeaves_s, 0.0, 0.05}});
    for (const bool leaps : {false, true}) {
        const Record record{.gaps = {{.from_s = 2.0, .to_s = kHeard_s, .leaps = leaps}}, .abort_s = kAbort_s, .released_s = kLeaves_s};
        CAPTURE(leaps);
        const Meter meter = metered(off, record, kEnd_s);
        CHECK_FALSE(meter.open());
        const Motion::At before = off.at(2.0), after = off.at(kSettled_s);
        const double radius = kRig.wheel_radius_m - kLoad_N / kRig.wheel_stiffness_Npm;
        const double lost_J = after.rim_J - before.rim_J;
        const double rolling = radius * (after.angle - before.angle) / (after.metres - before.metres);
        // A speed is that of half a window of 10 ms before.
        const double margin_J = 1.2 * kRig.flywheel_mass_kg * before.v_mps * 6.0 * 0.005;
        const double missing_J = (1.0 - rolling) * lost_J;
        CHECK(unknown_J(meter) == Approx(missing_J).margin(margin_J));
        CHECK(meter.figures().energy_brake_J ==
              Approx(off.brake_J(kEnd_s) - (off.at(kEnd_s).rolling_J - before.rolling_J) + rolling * lost_J).margin(margin_J));
        // The brake took more than is counted, and no more than is named.
        CHECK(meter.figures().energy_brake_J < off.brake_J(kEnd_s));
        CHECK(meter.figures().energy_brake_J + unknown_J(meter) > off.brake_J(kEnd_s) - margin_J);
        // A wheel that rolls with the rim has slip.
        for (const Motion& motion : {on, slower}) {
            CHECK(unknown_J(metered(motion, record, kEnd_s)) == 0.0);
            CHECK_FALSE(metered(motion, record, kEnd_s).warnings().empty());
        }
    }
    // Without an abort a held wheel has slip, too.
    const Motion held(25.0, {{}, {.from_s = kBrakeOn_s, .deceleration_mps2 = 6.0, .slip = 0.1}, {kLeaves_s, 6.0, 1.0}});
    CHECK(unknown_J(metered(held, {.gaps = {{.from_s = 2.0, .to_s = kHeard_s}}}, kEnd_s)) == 0.0);
    // Nor is anything unknown where all was heard.
    CHECK(unknown_J(metered(off, {.gaps = {}, .abort_s = kAbort_s, .released_s = kLeaves_s}, kEnd_s)) == 0.0);
}

TEST_CASE("readings that are late multiply the way up to their own time", "[BRG-200]") {
    const Motion motion(25.0, {{}, {.from_s = kBrakeOn_s, .deceleration_mps2 = 6.0, .slip = 0.1}});
    constexpr double kRise_s = 0.4, kTorque_Nm = 1500.0;
    const auto torque = [](double t) { return kTorque_Nm * std::clamp((t - kBrakeOn_s) / kRise_s, 0.0, 1.0); };
    double true_J = 0.0;
    for (double t = kBrakeOn_s; t < 2.5; t += 1e-4) true_J += torque(t + 5e-5) * (motion.at(t + 1e-4).angle - motion.at(t).angle);
    for (const int late_ms : {0, 8, 20, 30}) {
        for (const double told : {1.0, 0.0}) {
            CAPTURE(late_ms, told);
            const Meter meter =
                metered(motion, {.gaps = {}, .cells = [&](double t) { return torque(t - 1e-3 * late_ms); }, .age_s = told * 1e-3 * late_ms}, 2.5);
            const double share = meter.figures().energy_brake_J / true_J;
            if (told > 0.0 || late_ms == 0)
                CHECK(share == Approx(1.0).epsilon(0.002));
            else
                CHECK(share < 1.0 - 0.5e-3 * late_ms);
        }
    }
}
