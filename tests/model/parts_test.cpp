/// Tyre and brake against closed forms.
#include <array>
#include <cmath>

#include "tests/catch.hpp"
#include "tests/model/reference/profiles.hpp"
#include "tests/model/scenarios.hpp"

namespace {

std::vector<rig::Surface> surfaces() {
    std::vector<rig::Surface> all;
    for (const std::string& name : rig::surface_names("config")) {
        rig::ManeuverChoice choice;
        choice.surface = name;
        all.push_back(rig::load_rig("config", choice).rig.surface);
    }
    return all;
}

}  // namespace

TEST_CASE("tyre: every surface peaks where its coefficients say, and where the published table says", "[RIG-020]") {
    struct Published {
        const char* name;
        double slip, mu;
    };
    constexpr std::array<Published, 8> kPublished{{{"dry_asphalt", 0.170, 1.170},
                                                   {"dry_concrete", 0.160, 1.090},
                                                   {"dry_cobblestone", 0.400, 1.000},
                                                   {"damp_asphalt", 0.231, 0.919},
                                                   {"wet_asphalt", 0.131, 0.801},
                                                   {"wet_cobblestone", 0.140, 0.380},
                                                   {"snow", 0.060, 0.190},
                                                   {"ice", 0.032, 0.050}}};
    const auto all = surfaces();
    REQUIRE(all.size() == kPublished.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        const rig::Surface& s = all[i];
        CAPTURE(s.name);
        CHECK(s.name == kPublished.at(i).name);
        const rig::Peak peak = rig::peak(s);
        CHECK(std::abs(peak.slip - kPublished.at(i).slip) <= 0.001);
        CHECK(std::abs(peak.mu - kPublished.at(i).mu) <= 0.001);
        CHECK(peak.slip == Approx(std::log(s.c1 * s.c2 / s.c3) / s.c2).epsilon(1e-14));
        // Nothing on the curve is higher, and the slope vanishes there.
        for (int k = 0; k <= 10000; ++k) CHECK_FALSE(rig::friction(s, k * 1e-4).mu > peak.mu);
        CHECK(std::abs(rig::friction(s, peak.slip).mu_1) < 1e-12);
    }
}

TEST_CASE("tyre: eq. (4) for slip, its odd extension for overspeed, slope as by differences", "[RIG-020]") {
    for (const rig::Surface& s : surfaces()) {
        CAPTURE(s.name);
        for (double lambda = 1e-6; lambda < 1.0; lambda *= 1.07) {
            const rig::Friction f = rig::friction(s, lambda);
            const double printed = s.c1 * (1.0 - std::exp(-s.c2 * lambda)) - s.c3 * lambda;
            CHECK(f.mu == Approx(printed).epsilon(1e-13));
            const rig::Friction odd = rig::friction(s, -lambda);
            CHECK(odd.mu == -f.mu);
            CHECK(odd.mu_1 == f.mu_1);
            const double d = 1e-4 * lambda;
            const double slope = (rig::friction(s, lambda + d).mu - rig::friction(s, lambda - d).mu) / (2.0 * d);
            CHECK(f.mu_1 == Approx(slope).epsilon(1e-5).margin(1e-6 * s.c1 * s.c2));
        }
        CHECK(rig::friction(s, 0.0).mu == 0.0);
        CHECK(rig::friction(s, 0.0).mu_1 == Approx(s.c1 * s.c2 - s.c3).epsilon(1e-15));
    }
}

TEST_CASE("tyre: a curve without c3 never falls; its peak is at slip 1", "[RIG-020]") {
    const rig::Surface s{.name = "no c3", .c1 = 0.05, .c2 = 306.39, .c3 = 0.0};
    CHECK(rig::peak(s).slip == 1.0);
    CHECK(rig::peak(s).mu == Approx(0.05));
    // So weak that the peak would lie beyond a locked wheel, or below zero slip.
    CHECK(rig::peak({.name = "late", .c1 = 1.0, .c2 = 1.0, .c3 = 1e-3}).slip == 1.0);
    CHECK(rig::peak({.name = "none", .c1 = 0.1, .c2 = 1.0, .c3 = 0.2}).slip == 0.0);
}

TEST_CASE("tyre: the magic formula for slip, its odd extension, derivatives as by differences, its peak", "[RIG-264]") {
    const std::array<rig::MagicFormula, 5> curves{{{.B = 12.0, .C = 1.65, .D = 1.05, .E = 0.0},
                                                   {.B = 25.0, .C = 1.8, .D = 0.8, .E = -1.0},
                                                   {.B = 30.0, .C = 1.3, .D = 0.4, .E = 0.8},
                                                   {.B = 300.0, .C = 1.5, .D = 0.05, .E = -9.0},
                                                   {.B = 15.0, .C = 1.0, .D = 0.7, .E = 0.5}}};
    for (const rig::MagicFormula& m : curves) {
        CAPTURE(m.B, m.C, m.E);
        const rig::Surface s{.name = "magic", .magic = m};
        const rig::Peak peak = rig::peak(s);
        for (double lambda = 1e-4; lambda < 1.0; lambda *= 1.07) {
            CAPTURE(lambda);
            const auto printed = [&](double x) { return m.D * std::sin(m.C * std::atan(m.B * x - m.E * (m.B * x - std::atan(m.B * x)))); };
            const rig::Friction f = rig::friction(s, lambda);
            CHECK(f.mu == Approx(printed(lambda)).epsilon(1e-13));
            const rig::Friction odd = rig::friction(s, -lambda);
            CHECK(odd.mu == -f.mu);
            CHECK(odd.mu_1 == f.mu_1);
            CHECK(odd.mu_2 == -f.mu_2);
            const double d = 1e-4 * lambda, slope_at_rest = m.B * m.C * m.D;
            CHECK(f.mu_1 == Approx((printed(lambda + d) - printed(lambda - d)) / (2.0 * d)).epsilon(1e-6).margin(1e-7 * slope_at_rest));
            const double bend = (rig::friction(s, lambda + d).mu_1 - rig::friction(s, lambda - d).mu_1) / (2.0 * d);
            CHECK(f.mu_2 == Approx(bend).epsilon(1e-6).margin(1e-7 * slope_at_rest * m.B));
            CHECK(f.mu <= peak.mu);
            CHECK(f.mu > 0.0);
        }
        CHECK(rig::friction(s, 0.0).mu == 0.0);
        CHECK(rig::friction(s, 0.0).mu_1 == Approx(m.B * m.C * m.D).epsilon(1e-15));
        if (m.C > 1.0) {
            CHECK(peak.mu == Approx(m.D).epsilon(1e-14));
            CHECK(std::abs(rig::friction(s, peak.slip).mu_1) < 1e-9 * m.B);
        } else {
            CHECK(peak.slip == 1.0);  // it never falls
        }
    }
    const rig::Peak asked = rig::peak(rig::magic_formula_with_peak(0.07, 0.6, 1.7, 0.4));
    CHECK(asked.slip == Approx(0.07).epsilon(1e-12));
    CHECK(asked.mu == Approx(0.6).epsilon(1e-14));
    CHECK(rig::peak(rig::MagicFormula{.B = 6.0, .C = 1.3, .D = 0.4, .E = 0.8}).slip == 1.0);  // its peak is beyond
    // Without E the peak has a closed form.
    CHECK(rig::peak(curves[0]).slip == Approx(std::tan(0.5 * 3.14159265358979324 / 1.65) / 12.0).epsilon(1e-14));
}

TEST_CASE("tyre: eq. (4) has the second derivative that differences have", "[RIG-020]") {
    for (const rig::Surface& s : surfaces()) {
        CAPTURE(s.name);
        for (const double lambda : {-0.3, -0.02, 0.004, 0.05, 0.2, 0.9}) {
            const double d = 1e-5;
            const double bend = (rig::friction(s, lambda + d).mu_1 - rig::friction(s, lambda - d).mu_1) / (2.0 * d);
            CHECK(rig::friction(s, lambda).mu_2 == Approx(bend).epsilon(1e-4).margin(1e-6));
        }
    }
}

TEST_CASE("brake: k_b is eq. (5) with a friction curve brought to the given mean", "[RIG-020]") {
    const rig::BrakeGeometry geometry{.piston_area_m2 = 8.04e-4, .pistons = 6, .surfaces = 6, .effective_radius_m = 0.12};
    CHECK(geometry.gain_m3() == Approx(8.04e-4 * 6 * 6 * 0.12).epsilon(1e-15));
    constexpr double kSpeed_mps = 61.0;
    for (const rig::FrictionCurve& curve : {rig::FrictionCurve{0.33, -0.048, -0.018, 0.0}, rig::FrictionCurve{0.366, -0.306, 0.216, 0.06}}) {
        for (const double mean : {0.30, 0.22, 0.4}) {
            CAPTURE(mean);
            const plant::BrakeTorque brake(geometry, curve, mean, kSpeed_mps);
            const auto shape = [&](double x) { return curve[0] + x * (curve[1] + x * (curve[2] + x * curve[3])); };
            // Simpson's rule is exact for a cubic.
            const auto k_b = [&](double x) { return brake.gain(x * kSpeed_mps).k_b; };
            CHECK((k_b(0.0) + 4.0 * k_b(0.5) + k_b(1.0)) / 6.0 == Approx(mean * geometry.gain_m3()).epsilon(1e-13));
            for (double x = 0.05; x < 1.0; x += 0.05) {
                CAPTURE(x);
                // Biased, not scaled.
                CHECK(k_b(x) - k_b(0.0) == Approx((shape(x) - shape(0.0)) * geometry.gain_m3()).margin(1e-15));
                const double d = 1e-5;
                const double slope = (k_b(x + d) - k_b(x - d)) / (2.0 * d * kSpeed_mps);
                CHECK(brake.gain(x * kSpeed_mps).k_b1 == Approx(slope).epsilon(1e-6).margin(1e-12));
            }
            CHECK(brake.gain(1.3 * kSpeed_mps).k_b == brake.gain(kSpeed_mps).k_b);
            CHECK(brake.gain(1.3 * kSpeed_mps).k_b1 == 0.0);
        }
    }
}

TEST_CASE("brake: eq. (7) gives back the mean friction from a stop", "[RIG-020]") {
    for (const std::string maneuver : {"light", "medium_a", "heavy"}) {
        rig::ManeuverChoice choice;
        choice.maneuver = maneuver;
        choice.friction = 0.27;
        const rig::RigParameters rig = rig::load_rig("config", choice).rig;
        plant::Rig plant(rig, 1e-3, 1);
        plant.start_rolling();
        // Constant pressure far below the peak: what differs from constant deceleration is the curve itself, by some 10 %, so
        // that the mean over time weighs speeds unequally in the first order of that.
        const double pressure_Pa = 0.3 * min_peak_pressure_Pa(rig);
        double torque_Nms = 0.0;
        double duration_s = 0.0;
        plant.start_pressure(pressure_Pa);
        while (plant.wheel().v_mps > 1.0) {
            const double before = plant.forces().brake_torque_Nm;
            plant.advance_pressure(pressure_Pa, pressure_Pa);
            torque_Nms += 0.5e-3 * (before + plant.forces().brake_torque_Nm);
            duration_s += 1e-3;
        }
        CAPTURE(maneuver);
        CHECK(torque_Nms / duration_s / pressure_Pa / rig.brake.gain_m3() == Approx(0.27).epsilon(0.02));
    }
}
