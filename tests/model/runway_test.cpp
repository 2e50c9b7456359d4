/// Wet friction worked in fractions from the same coefficients, hydroplaning, the runway's file, and the keys that make a plant hard.
#include <algorithm>
#include <cmath>
#include <fstream>

#include "plant_sim/model/rig.hpp"
#include "rig_bridge/rig/load_rig.hpp"
#include "rig_bridge/rig/load_runway.hpp"
#include "rig_bridge/rig/wet_grip.hpp"
#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"

using rig::Texture;
using rig::WetGrip;

namespace {

constexpr double kKnot_mps = 1852.0 / 3600.0;

/// landing_gear.toml with more at its end, the rest of config/ as shipped.
struct HardConfig {
    explicit HardConfig(const std::string& from, const std::string& to = "") {
        std::filesystem::copy("config", directory.path(), std::filesystem::copy_options::recursive);
        std::string text = content_of("config/landing_gear.toml");
        if (to.empty()) {
            text += from;
        } else {
            const std::size_t at = text.find(from);
            REQUIRE(at != std::string::npos);
            text.replace(at, from.size(), to);
        }
        put(directory / "landing_gear.toml", text);
    }
    [[nodiscard]] rig::RigParameters rig(const rig::ManeuverChoice& choice = {}) const { return rig::load_rig(directory.path(), choice).rig; }
    TemporaryDirectory directory;
};

rig::LoadedRig on_runway(const std::string& text, const std::filesystem::path& file) {
    put(file, text);
    rig::ManeuverChoice choice;
    choice.runway = file;
    return rig::load_rig("config", choice);
}

}  // namespace

TEST_CASE("wet friction is the polynomials' value, in exact fractions at 0, 50, 100 and 150 knots", "[RIG-262]") {
    struct Printed {
        double psi;
        Texture texture;
        double at_0, at_50, at_100, at_150;
    };
    // a x^3 + b x^2 + c x + d and its like of order five, x = 0, 0.5, 1, 1.5, in rational arithmetic. A wrong coefficient would be wrong
    // here, too.
    for (const Printed& p :
         {Printed{50.0, Texture::smooth, 0.883, 0.529625, 0.303, 0.176875}, Printed{100.0, Texture::smooth, 0.804, 0.4760375, 0.2753, 0.1690125},
          Printed{200.0, Texture::smooth, 0.692, 0.4218625, 0.2529, 0.1602875}, Printed{300.0, Texture::smooth, 0.614, 0.3692375, 0.2259, 0.1539125},
          Printed{50.0, Texture::grooved, 0.859, 0.66284375, 0.349, 0.24878125},
          Printed{100.0, Texture::grooved, 0.807, 0.63439375, 0.3516, 0.24530625},
          Printed{200.0, Texture::grooved, 0.701, 0.56893125, 0.3478, 0.23054375},
          Printed{300.0, Texture::grooved, 0.614, 0.48789875, 0.31286, 0.20757125}}) {
        CAPTURE(p.psi, p.texture == Texture::smooth);
        const WetGrip grip(p.psi, p.texture);
        CHECK(grip.at(0.0).mu == Approx(p.at_0).epsilon(1e-12));
        CHECK(grip.at(50.0 * kKnot_mps).mu == Approx(p.at_50).epsilon(1e-12));
        CHECK(grip.at(100.0 * kKnot_mps).mu == Approx(p.at_100).epsilon(1e-12));
        CHECK(grip.at(150.0 * kKnot_mps).mu == Approx(p.at_150).epsilon(1e-12));
    }
}

TEST_CASE("wet friction falls with speed and with tyre pressure, and grooves help above 20 knots", "[RIG-262]") {
    for (double knots = 20.0; knots < 170.0; knots += 1.0) {
        CAPTURE(knots);
        const double v = knots * kKnot_mps;
        for (const Texture texture : {Texture::smooth, Texture::grooved}) {
            double softer = 1.0;
            for (double psi = 50.0; psi <= 300.0; psi += 12.5) {
                CAPTURE(psi);
                const WetGrip grip(psi, texture);
                const WetGrip::Peak here = grip.at(v);
                CHECK(here.mu > 0.05);
                CHECK(here.mu_v < 0.0);
                CHECK(here.mu_v == Approx((grip.at(v + 1e-3).mu - grip.at(v - 1e-3).mu) / 2e-3).epsilon(1e-6));
                if (texture == Texture::smooth) CHECK(here.mu < softer);
                softer = here.mu;
                CHECK(WetGrip(psi, Texture::grooved).at(v).mu > WetGrip(psi, Texture::smooth).at(v).mu);
            }
        }
    }
}

TEST_CASE("between the printed pressures friction is linear; beyond them there is none", "[RIG-262]") {
    for (const Texture texture : {Texture::smooth, Texture::grooved}) {
        for (const double v : {0.0, 20.0, 45.0, 70.0}) {
            const double low = WetGrip(200.0, texture).at(v).mu, high = WetGrip(300.0, texture).at(v).mu;
            CHECK(WetGrip(230.0, texture).at(v).mu == Approx(0.7 * low + 0.3 * high).epsilon(1e-12));
        }
    }
    for (const double psi : {49.9, 300.1, 0.0, -1.0, std::nan("")}) CHECK_THROWS_AS(WetGrip(psi, Texture::smooth), std::invalid_argument);
    for (const double mu : {-0.01, 0.11, std::nan("")}) CHECK_THROWS_AS(WetGrip(100.0, Texture::smooth, mu), std::invalid_argument);
}

TEST_CASE("on a flooded runway friction is gone at 9 sqrt(p) knots, for a wheel that stands at 7.7 sqrt(p)", "[RIG-262]") {
    for (const double psi : {50.0, 81.0, 144.0, 300.0}) {
        const WetGrip wet(psi, Texture::smooth), flooded(psi, Texture::smooth, 0.04);
        for (const bool spun_up : {true, false}) {
            CAPTURE(psi, spun_up);
            const double floats_mps = (spun_up ? 9.0 : 7.7) * std::sqrt(psi) * kKnot_mps;
            CHECK(flooded.hydroplaning_mps(spun_up) == Approx(floats_mps).epsilon(1e-12));
            CHECK(flooded.at(floats_mps + 1e-9, spun_up).mu == 0.04);
            CHECK(flooded.at(2.0 * floats_mps, spun_up).mu == 0.04);
            CHECK(flooded.at(0.8499 * floats_mps, spun_up).mu == wet.at(0.8499 * floats_mps).mu);
            // Continuous with its slope at both ends: the integrator's error control counts on it.
            for (const double end : {0.85 * floats_mps, floats_mps}) {
                const auto below = flooded.at(end - 1e-7, spun_up), above = flooded.at(end + 1e-7, spun_up);
                CHECK(below.mu == Approx(above.mu).margin(1e-7));
                CHECK(below.mu_v == Approx(above.mu_v).margin(1e-6));
            }
            for (double v = 0.86 * floats_mps; v < 0.99 * floats_mps; v += 0.3) {
                const double slope = (flooded.at(v + 1e-4, spun_up).mu - flooded.at(v - 1e-4, spun_up).mu) / 2e-4;
                CHECK(flooded.at(v, spun_up).mu_v == Approx(slope).epsilon(1e-5));
                CHECK(slope < 0.0);
            }
        }
    }
}

TEST_CASE("a wheel that touches down between the two speeds floats until it has spun up", "[RIG-262]") {
    const TemporaryDirectory directory;
    rig::RigParameters rig = on_runway(
                                 "[[patch]]\nfrom_m = 0\nwet = {tyre_pressure_psi = 100, texture = \"smooth\", "
                                 "flooded = true, flooded_mu = 0.02}\n",
                                 directory / "r.toml")
                                 .rig;
    const WetGrip grip = *rig.surface.wet;
    rig.brake_on_mps = 0.5 * (0.85 * grip.hydroplaning_mps(true) + grip.hydroplaning_mps(false));
    plant::Rig landing(rig, 1e-3, 1);
    landing.touch_down();
    landing.advance_current(0.0);
    const double curve = rig::friction(rig.surface, 1.0).mu / rig::peak(rig.surface).mu;
    CHECK(landing.forces().mu == Approx(0.02 * curve).epsilon(0.05));
    for (int i = 0; i < 3000; ++i) landing.advance_current(0.0);
    CHECK(landing.wheel().omega_radps * landing.forces().radius_m == Approx(landing.wheel().v_mps).epsilon(1e-3));
    CHECK(rig::peak(landing.surface(), landing.wheel().v_mps).mu > 0.2);
}

TEST_CASE("a wheel held from touchdown on a wet runway stops where the quadrature says", "[RIG-262]") {
    const TemporaryDirectory directory;
    rig::RigParameters rig = on_runway("[[patch]]\nfrom_m = 0\nwet = {tyre_pressure_psi = 160, texture = \"grooved\"}\n", directory / "r.toml").rig;
    rig.load.lift_Ns2pm2 = 0.0;
    plant::Rig stop(rig, 1e-3, 1);
    stop.touch_down();
    const double from_mps = stop.wheel().v_mps;
    while (stop.wheel().v_mps > 5.0) stop.advance_pressure(20.7e6, 20.7e6);
    const double to_mps = stop.wheel().v_mps;
    const double curve = rig::friction(rig.surface, 1.0).mu / rig::peak(rig.surface).mu;
    // x = integral of v dv / (g mu(v)), by Simpson.
    constexpr int kParts = 2000;
    double metres = 0.0;
    for (int i = 0; i <= kParts; ++i) {
        const double v = to_mps + (from_mps - to_mps) * i / kParts;
        const double weight = i == 0 || i == kParts ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
        metres += weight * v / (9.80665 * curve * rig.surface.wet->at(v).mu);
    }
    metres *= (from_mps - to_mps) / kParts / 3.0;
    CHECK(stop.wheel().distance_m == Approx(metres).epsilon(1e-7));
    CHECK(stop.kinetic_energy_J() + stop.wheel().energy_tyre_J == Approx(0.5 * rig.wheel.mass_kg * from_mps * from_mps).epsilon(1e-9));
}

TEST_CASE("a runway's file: surfaces by name, wet ones by the regulation, counted from touchdown", "[RIG-262]") {
    const TemporaryDirectory directory;
    const rig::LoadedRig loaded = on_runway(
        "[[patch]]\nfrom_m = 0.0\nsurface = \"dry_asphalt\"\n"
        "[[patch]]\nfrom_m = 30.0\nwet = {tyre_pressure_psi = 120, texture = \"smooth\", peak_slip = 0.09}\n"
        "[[patch]]\nfrom_m = 60.0\nwet = {tyre_pressure_psi = 120, texture = \"grooved\", curve = "
        "\"snow\"}\n",
        directory / "r.toml");
    const rig::Runway& runway = loaded.rig.runway;
    REQUIRE(runway.patches.size() == 3);
    CHECK(loaded.rig.surface.name == "dry_asphalt");
    CHECK(std::find(loaded.files.begin(), loaded.files.end(), directory / "r.toml") != loaded.files.end());
    CHECK(runway.from_touchdown);
    CHECK_FALSE(runway.patches[0].surface.wet);
    const rig::Surface& early = runway.patches[1].surface;
    CHECK(early.name == "wet smooth at 120 psi");
    CHECK(rig::peak(early, 30.0).slip == Approx(0.09).epsilon(1e-12));
    CHECK(rig::peak(early, 30.0).mu == WetGrip(120.0, Texture::smooth).at(30.0).mu);
    CHECK(rig::peak(runway.patches[2].surface).slip == Approx(0.060).margin(1e-3));

    plant::Rig rig(loaded.rig, 1e-3, 1);
    for (int i = 0; i < 1000; ++i) rig.advance_current(0.0);  // 61 m of approach
    for (int landing = 0; landing < 2; ++landing) {
        rig.touch_down();
        CHECK(rig.runway_m() == 0.0);
        const double began_m = rig.wheel().distance_m;
        while (rig.runway_m() < 70.0) {
            const double before_m = rig.wheel().distance_m - began_m;
            rig.advance_current(0.0);
            const std::string& under = rig.surface().name;
            CHECK(under == (before_m < 30.0 ? "dry_asphalt" : before_m < 60.0 ? "wet smooth at 120 psi" : "wet grooved at 120 psi"));
        }
        rig.lift_off();
    }
}

TEST_CASE("every mistake in a runway's file is refused with file, line and key", "[RIG-262]") {
    struct Mistake {
        const char* text;
        std::size_t line;
        const char* says;
    };
    for (const Mistake& m : {
             Mistake{"", 0, "patch"},
             Mistake{"[[patch]]\nfrom_m = 5.0\nsurface = \"ice\"\n", 2, "begins at 0"},
             Mistake{"[[patch]]\nfrom_m = 0\nsurface = \"ice\"\n[[patch]]\nfrom_m = 0.0\nsurface = \"ice\"\n", 5, "behind the patch before it"},
             Mistake{"[[patch]]\nfrom_m = 0\n", 1, "expected surface"},
             Mistake{"[[patch]]\nfrom_m = 0\nsurface = \"ice\"\nwet = {}\n", 4, "one of them"},
             Mistake{"[[patch]]\nfrom_m = 0\nsurface = \"grass\"\n", 3, "wet_cobblestone"},
             Mistake{"[[patch]]\nfrom_m = 0\nlength_m = 3\nsurface = \"ice\"\n", 3, "length_m"},
             Mistake{"[[patch]]\nfrom_m = 0\nwet = {texture = \"smooth\"}\n", 3, "tyre_pressure_psi"},
             Mistake{"[[patch]]\nfrom_m = 0\nwet = {tyre_pressure_psi = 40, texture = \"smooth\"}\n", 3, "50 to 300"},
             Mistake{"[[patch]]\nfrom_m = 0\nwet = {tyre_pressure_psi = 90, texture = \"rough\"}\n", 3, "grooved"},
             Mistake{"[[patch]]\nfrom_m = 0\nwet = {tyre_pressure_psi = 90, texture = \"smooth\", flooded_mu = "
                     "0.03}\n",
                     3, "flooded = true"},
             Mistake{"[[patch]]\nfrom_m = 0\nwet = {tyre_pressure_psi = 90, texture = \"smooth\", flooded = "
                     "true, "
                     "flooded_mu = 0.3}\n",
                     3, "0 to 0.1"},
             Mistake{"[[patch]]\nfrom_m = 0\nwet = {tyre_pressure_psi = 90, texture = \"smooth\", curve = "
                     "\"mud\"}\n",
                     3, "mud"},
             Mistake{"[[patch]]\nfrom_m = 0\nwet = {tyre_pressure_psi = 90, texture = \"smooth\", peak_slip = "
                     "0.03}\n",
                     3, "later peak"},
         }) {
        CAPTURE(m.text);
        const TemporaryDirectory directory;
        const auto error = rejection_of([&] { return on_runway(m.text, directory / "r.toml"); });
        CHECK(error.file() == (directory / "r.toml").string());
        CHECK(error.line() == m.line);
        CHECK_THAT(error.what(), ContainsSubstring(m.says));
    }
}

TEST_CASE("a patch of a magic formula is that surface from there on, and its wet curve is stretched over slip", "[RIG-264]") {
    constexpr rig::MagicFormula kPacejka{.B = 14.0, .C = 1.7, .D = 0.9, .E = -0.6};
    const rig::Surface magic{.name = "magic", .magic = kPacejka};
    rig::RigParameters all = rig::load_rig("config", {}).rig, patch = all;
    all.surface = magic;
    patch.runway.patches = {{0.0, magic}};
    plant::Rig a(all, 1e-3, 1), b(patch, 1e-3, 1);
    for (plant::Rig* one : {&a, &b}) {
        one->start_rolling();
        for (int i = 0; i < 600; ++i) one->advance_current(20.0, 20.0);
    }
    CHECK(a.wheel().omega_radps == b.wheel().omega_radps);
    CHECK(a.wheel().v_mps < all.brake_on_mps - 1.0);
    CHECK(b.forces().mu == Approx(rig::friction(kPacejka, b.forces().slip).mu).epsilon(1e-12));

    const TemporaryDirectory directory;
    std::ofstream(directory / "r.toml")
        << "[[patch]]\nfrom_m = 0\nwet = {tyre_pressure_psi = 90, texture = \"smooth\", curve = \"magic\", peak_slip = 0.2}\n";
    const rig::Runway runway = rig::load_runway(directory / "r.toml", {magic});
    CHECK(rig::peak(runway.patches.at(0).surface).slip == Approx(0.2).epsilon(1e-12));
    CHECK(rig::peak(runway.patches.at(0).surface).mu == Approx(0.9).epsilon(1e-12));
}

TEST_CASE("the shipped runways are read", "[RIG-262]") {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator("config/runways")) {
        rig::ManeuverChoice choice;
        choice.runway = entry.path();
        CHECK_FALSE(rig::load_rig("config", choice).rig.runway.plain());
        CHECK(choice.road() == entry.path().stem().string());
        ++count;
    }
    CHECK(count == 4);
}

TEST_CASE("tyre, leg, teeth and line stand in the rig's file; without them it is the paper's", "[RIG-250]") {
    const rig::RigParameters paper = rig::load_rig("config", {}).rig;
    CHECK_FALSE(paper.wheel.compliance.any());
    CHECK(paper.valve.line_s == 0.0);
    CHECK(paper.wheel_encoder.pitch_error == 0.0);
    CHECK(paper.wheel_encoder.eccentricity == 0.0);

    CHECK_FALSE(HardConfig("\n[tyre]\nmodel = \"static\"\n").rig().wheel.compliance.any());
    const auto ring = HardConfig(
                          "\n[tyre]\nmodel = \"ring\"\nbelt_share = 0.35\nfrequency_Hz = 80\ndamping = 0.06\n"
                          "[leg]\nmass_kg = 120\nfrequency_Hz = 12\ndamping = 0.05\n")
                          .rig()
                          .wheel.compliance;
    CHECK(ring.ring.belt_share == 0.35);
    CHECK(ring.ring.frequency_Hz == 80.0);
    CHECK(ring.ring.damping == 0.06);
    CHECK(ring.relaxation.length_m == 0.0);
    CHECK(ring.leg.mass_kg == 120.0);
    CHECK(ring.leg.frequency_Hz == 12.0);
    const HardConfig relaxing(
        "\n[tyre]\nmodel = \"relaxation\"\nlength_m = 0.2\nfloor_m = 0.03\n[leg]\nmass_kg = "
        "120\nfrequency_Hz = 12\ndamping = 0.05\n");
    CHECK(relaxing.rig().wheel.compliance.relaxation.length_m == 0.2);
    CHECK(relaxing.rig().wheel.compliance.relaxation.floor_m == 0.03);
    rig::ManeuverChoice on_flywheel;
    on_flywheel.carrier = rig::Carrier::flywheel;
    CHECK(relaxing.rig(on_flywheel).wheel.compliance.leg.mass_kg == 0.0);  // a sledge carries the wheel
    CHECK(relaxing.rig(on_flywheel).wheel.compliance.relaxation.length_m == 0.2);
    const HardConfig line("delay_ms = 6.0", "line_ms = 4.0\ndelay_ms = 6.0");
    CHECK(line.rig().valve.line_s == Approx(4e-3).epsilon(1e-15));
    const auto teeth = HardConfig("[wheel.encoder]", "[wheel.encoder]\npitch_error = 0.01\neccentricity = 0.002").rig();
    CHECK(teeth.wheel_encoder.pitch_error == 0.01);
    CHECK(teeth.wheel_encoder.eccentricity == 0.002);
    CHECK(teeth.flywheel_encoder.pitch_error == 0.0);
}

TEST_CASE("tyre, leg, teeth and line that cannot be are refused by name", "[RIG-250]") {
    struct Mistake {
        const char *from, *to, *key;
    };
    constexpr const char* kEncoder = "[wheel.encoder]";
    for (const Mistake& m : {
             Mistake{"\n[tyre]\n", "", "tyre.model"},
             Mistake{"\n[tyre]\nmodel = \"brush\"\n", "", "tyre.model"},
             Mistake{"\n[tyre]\nmodel = \"static\"\nbelt_share = 0.3\n", "", "tyre.belt_share"},
             Mistake{"\n[tyre]\nmodel = \"ring\"\nfrequency_Hz = 80\ndamping = 0.06\n", "", "tyre.belt_share"},
             Mistake{"\n[tyre]\nmodel = \"ring\"\nbelt_share = 1.0\nfrequency_Hz = 80\ndamping = 0.06\n", "", "tyre.belt_share"},
             Mistake{"\n[tyre]\nmodel = \"ring\"\nbelt_share = 0.3\nfrequency_Hz = 0\ndamping = 0.06\n", "", "tyre.frequency_Hz"},
             Mistake{"\n[tyre]\nmodel = \"ring\"\nbelt_share = 0.3\nfrequency_Hz = 80\ndamping = -0.1\n", "", "tyre.damping"},
             Mistake{"\n[tyre]\nmodel = \"relaxation\"\nlength_m = 3.0\nfloor_m = 0.02\n", "", "tyre.length_m"},
             Mistake{"\n[tyre]\nmodel = \"relaxation\"\nlength_m = 0.3\n", "", "tyre.floor_m"},
             Mistake{"\n[leg]\nmass_kg = 120\nfrequency_Hz = 12\n", "", "leg.damping"},
             Mistake{"\n[leg]\nmass_kg = 120\nfrequency_Hz = 0.1\ndamping = 0.1\n", "", "leg.frequency_Hz"},
             Mistake{"delay_ms = 6.0", "line_ms = -1.0\ndelay_ms = 6.0", "valve.line_ms"},
             Mistake{"delay_ms = 6.0", "line_s = 0.004\ndelay_ms = 6.0", "valve.line_s"},
             Mistake{kEncoder, "[wheel.encoder]\npitch_error = 0.4", "wheel.encoder.pitch_error"},
             Mistake{kEncoder, "[wheel.encoder]\neccentricity = -0.1", "wheel.encoder.eccentricity"},
         }) {
        CAPTURE(m.from, m.to);
        const HardConfig config(m.from, m.to);
        const auto error = rejection_of([&] { return config.rig(); });
        CHECK(error.key() == m.key);
        CHECK(error.file() == (config.directory / "landing_gear.toml").string());
        CHECK(error.line() > 0);
    }
    rig::ManeuverChoice light;
    light.mass_kg = 150.0;
    light.speed_mps = 10.0;
    const HardConfig heavy_leg("\n[leg]\nmass_kg = 200\nfrequency_Hz = 12\ndamping = 0.05\n");
    CHECK(rejection_of([&] { return heavy_leg.rig(light); }).key() == "leg.mass_kg");
}
