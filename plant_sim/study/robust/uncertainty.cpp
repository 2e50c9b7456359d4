#include "plant_sim/study/robust/uncertainty.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "firmware/host/settings/settings.hpp"
#include "plant_sim/study/robust/grids.hpp"
#include "rig_bridge/wear/draw.hpp"

namespace robust {

namespace {

using settings::Table;

Interval interval(const Table& t, std::string_view key, const settings::Range& range) {
    const std::vector<double> ends = t.numbers(key, {.range = range, .count = {.min = 2, .max = 2}});
    if (ends[1] < ends[0]) t.fail(key, "the second number is below the first; expected [least, most]");
    return {ends[0], ends[1]};
}

double within(const Interval& range, wear::Generator& generator) {
    return range.low + (range.high - range.low) * wear::uniform(generator);
}

double within_logarithm(const Interval& range, wear::Generator& generator) {
    return range.low * std::pow(range.high / range.low, wear::uniform(generator));
}

void add_ring(const Uncertainty& u, rig::RigParameters& rig, wear::Generator& g) {
    rig.wheel.compliance.ring = {.belt_share = within(u.belt_share, g), .frequency_Hz = within(u.ring_Hz, g), .damping = within(u.ring_damping, g)};
}

void add_relaxation(const Uncertainty& u, rig::RigParameters& rig, wear::Generator& g) {
    rig.wheel.compliance.relaxation = {.length_m = within_logarithm(u.relaxation_m, g), .floor_m = u.relaxation_floor_m};
}

void add_leg(const Uncertainty& u, rig::RigParameters& rig, wear::Generator& g) {
    rig.wheel.compliance.leg = {.mass_kg = within(u.leg_kg, g), .frequency_Hz = within(u.leg_Hz, g), .damping = within(u.leg_damping, g)};
}

void change_parameters(const Uncertainty& u, rig::RigParameters& rig, wear::Generator& g) {
    rig.wheel.inertia_kgm2 *= within(u.wheel_inertia, g);
    rig.brake.piston_area_m2 *= within(u.brake_gain, g);
    rig.valve.natural_frequency_radps *= within(u.valve_frequency, g);
    rig.valve.delay_s = within(u.delay_s, g);
    rig.valve.hysteresis_mA = within(u.hysteresis_mA, g);
    const double load = within(u.load, g);
    rig.load.base_N *= load;
    for (rig::EncoderParameters* encoder : {&rig.wheel_encoder, &rig.flywheel_encoder}) {
        encoder->pitch_error = within(u.pitch_error, g);
        encoder->eccentricity = within(u.eccentricity, g);
    }
}

void add_patches(const Basis& basis, rig::RigParameters& rig, wear::Generator& g) {
    constexpr double kLongest_m = 6000.0;  // of a stop on ice, beyond which the last patch stays
    double from_m = 0.0;
    while (from_m < kLongest_m) {
        from_m += within_logarithm(basis.uncertainty.patch_m, g);
        const auto which = static_cast<std::size_t>(wear::uniform(g) * static_cast<double>(basis.surfaces.size()));
        rig.runway.patches.push_back({from_m, basis.surfaces[which]});
    }
}

/// A magic formula with the peak friction of the landing's surface.
void change_curve(const Uncertainty& u, rig::RigParameters& rig, wear::Generator& g) {
    const double peak_slip = within_logarithm(u.curve_peak_slip, g);
    const double C = within(u.curve_C, g), E = within(u.curve_E, g);
    rig.surface.magic = rig::magic_formula_with_peak(peak_slip, rig::peak(rig.surface).mu, C, E);
}

/// A parabola through the friction at brake-on, at half of that speed and at the end, relative to their mean over the stop.
void change_brake(const Uncertainty& u, rig::RigParameters& rig, wear::Generator& g) {
    rig.clamping = {.contact_Pa = within(u.contact_Pa, g),
                    .piston_friction = within(u.piston_friction, g),
                    .run_out = within(u.run_out, g),
                    .warp = within(u.warp, g)};
    const double begin = within(u.friction_brake_on, g), half_way = within(u.friction_half_way, g), end = within(u.friction_end, g);
    const double per_mean = rig.mean_friction * 6.0 / (begin + 4.0 * half_way + end);  // Simpson's rule, exact for a parabola
    rig.friction_curve = {end * per_mean, (4.0 * half_way - 3.0 * end - begin) * per_mean, 2.0 * (begin + end - 2.0 * half_way) * per_mean, 0.0};
}

}  // namespace

Uncertainty load_uncertainty(const std::filesystem::path& file) {
    const settings::Document doc = settings::Document::load(file);
    const Table root = doc.root();
    const Table landing = root.table("landing"), ring = root.table("ring"), relaxation = root.table("relaxation"), leg = root.table("leg"),
                parameters = root.table("parameters"), patches = root.table("patches"), curves = root.table("curves"), brakes = root.table("brakes"),
                changes = root.table("changes"), brake_on = root.table("brake_on");
    constexpr settings::Range kFactor{.min = 0.1, .max = 10.0}, kDamping{.min = 0.0, .max = 1.0}, kGrid_mps{.min = 6.0, .max = 61.0},
        kClampingShare{.min = 0.0, .max = 0.45};
    const Interval delay_ms = interval(parameters, "delay_ms", {.min = 0.0, .max = 100.0});
    Uncertainty u{.slip_reference = landing.number("slip_reference", {.min = 0.0, .max = 0.5}),
                  .speed_mps = interval(landing, "speed_mps", {.min = 6.0, .max = 120.0}),
                  .belt_share = interval(ring, "belt_share", {.min = 0.01, .max = 0.9}),
                  .ring_Hz = interval(ring, "frequency_Hz", {.min = 5.0, .max = 1000.0}),
                  .ring_damping = interval(ring, "damping", kDamping),
                  .relaxation_m = interval(relaxation, "length_m", {.min = 0.001, .max = 2.0}),
                  .relaxation_floor_m = relaxation.number("floor_m", {.min = 0.001, .max = 2.0}),
                  .leg_kg = interval(leg, "mass_kg", {.min = 1.0, .max = 1000.0}),
                  .leg_Hz = interval(leg, "frequency_Hz", {.min = 1.0, .max = 100.0}),
                  .leg_damping = interval(leg, "damping", kDamping),
                  .wheel_inertia = interval(parameters, "wheel_inertia", kFactor),
                  .brake_gain = interval(parameters, "brake_gain", kFactor),
                  .valve_frequency = interval(parameters, "valve_frequency", kFactor),
                  .delay_s = {delay_ms.low * 1e-3, delay_ms.high * 1e-3},
                  .hysteresis_mA = interval(parameters, "hysteresis_mA", {.min = 0.0, .max = 20.0}),
                  .load = interval(parameters, "load", {.min = 0.5, .max = 2.0}),
                  .pitch_error = interval(parameters, "pitch_error", {.min = 0.0, .max = 0.3}),
                  .eccentricity = interval(parameters, "eccentricity", {.min = 0.0, .max = 0.1}),
                  .patch_m = interval(patches, "length_m", {.min = 1.0, .max = 10000.0}),
                  .curve_peak_slip = interval(curves, "peak_slip", {.min = 0.01, .max = 0.9}),
                  .curve_C = interval(curves, "C", {.min = 1.1, .max = 1.99}),
                  .curve_E = interval(curves, "E", {.min = -10.0, .max = 0.95}),
                  .contact_Pa = interval(brakes, "contact_Pa", {.min = 0.0, .max = 1e7}),
                  .piston_friction = interval(brakes, "piston_friction", kClampingShare),
                  .run_out = interval(brakes, "run_out", kClampingShare),
                  .warp = interval(brakes, "warp", kClampingShare),
                  .friction_brake_on = interval(brakes, "brake_on", kFactor),
                  .friction_half_way = interval(brakes, "half_way", kFactor),
                  .friction_end = interval(brakes, "end", kFactor),
                  .change_mps = changes.numbers("speed_mps", {.range = kGrid_mps}),
                  .brake_on_mps = brake_on.numbers("speed_mps", {.range = kGrid_mps, .strictly_increasing = true})};
    doc.finish();
    return u;
}

Draw draw(const Basis& basis, Family family, std::uint64_t seed, std::size_t number) {
    if (grid_size(basis, family) > 0) return grid_stop(basis, family, number);
    constexpr std::uint64_t kFamilyStride = std::uint64_t{1} << 32U;
    wear::Generator g = wear::generator_of(seed, static_cast<std::uint64_t>(family) * kFamilyStride + number);
    const Uncertainty& u = basis.uncertainty;
    const std::size_t landing = number % basis.landings.size();
    Draw drawn{.landing = landing, .rig = basis.landings[landing].rig};
    rig::RigParameters& rig = drawn.rig;
    const bool all = family == Family::all;
    const bool coin = wear::uniform(g) < 0.5;
    if (family == Family::ring || (all && coin)) add_ring(u, rig, g);
    if (family == Family::relaxation || (all && !coin)) add_relaxation(u, rig, g);
    if (family == Family::leg || all) add_leg(u, rig, g);
    if (family == Family::parameters || all) change_parameters(u, rig, g);
    if (family == Family::patches || all) add_patches(basis, rig, g);
    if (family == Family::curves) change_curve(u, rig, g);
    if (family == Family::brakes) change_brake(u, rig, g);
    if (family == Family::speed) {
        rig.brake_on_mps = within(u.speed_mps, g);
        rig.touchdown_mps = 0.0;
    }
    return drawn;
}

std::string describe(const Basis& basis, const Draw& d) {
    const NominalLanding& landing = basis.landings[d.landing];
    const auto& [ring, relaxation, leg] = d.rig.wheel.compliance;
    std::string text = fmt::format("{} {}", landing.maneuver, landing.surface);
    if (ring.belt_share > 0.0) text += fmt::format(", ring {:.1f} Hz damping {:.3f} belt {:.2f}", ring.frequency_Hz, ring.damping, ring.belt_share);
    if (relaxation.length_m > 0.0) text += fmt::format(", relaxation {:.3f} m", relaxation.length_m);
    if (leg.mass_kg > 0.0) text += fmt::format(", leg {:.0f} kg {:.1f} Hz damping {:.3f}", leg.mass_kg, leg.frequency_Hz, leg.damping);
    const rig::RigParameters& plain = landing.rig;
    if (d.rig.valve.delay_s != plain.valve.delay_s)
        text += fmt::format(
            ", J x{:.2f}, k_b x{:.2f}, valve {:.0f} Hz delay {:.1f} ms hysteresis {:.1f} mA, load x{:.2f}, wheel's teeth {:.1f} % eccentric {:.2f} "
            "%, flywheel's teeth {:.1f} % eccentric {:.2f} %",
            d.rig.wheel.inertia_kgm2 / plain.wheel.inertia_kgm2, d.rig.brake.piston_area_m2 / plain.brake.piston_area_m2,
            d.rig.valve.natural_frequency_radps / 6.283185307179586, d.rig.valve.delay_s * 1e3, d.rig.valve.hysteresis_mA,
            d.rig.load.base_N / plain.load.base_N, d.rig.wheel_encoder.pitch_error * 100.0, d.rig.wheel_encoder.eccentricity * 100.0,
            d.rig.flywheel_encoder.pitch_error * 100.0, d.rig.flywheel_encoder.eccentricity * 100.0);
    if (const auto& curve = d.rig.surface.magic; curve && !plain.surface.magic)
        text += fmt::format(", peak at slip {:.3f}, locked {:.2f} of it, C {:.2f} E {:.2f}", rig::peak(*curve).slip,
                            rig::friction(*curve, 1.0).mu / curve->D, curve->C, curve->E);
    if (const rig::Clamping& c = d.rig.clamping; c.any() && !plain.clamping.any()) {
        const auto& f = d.rig.friction_curve;
        const double per_mean = 1.0 / d.rig.mean_friction;
        text += fmt::format(
            ", contact {:.2f} MPa, piston friction {:.1f} %, run-out {:.1f} %, warp {:.1f} %, friction {:.2f} at brake-on, {:.2f} half-way, {:.2f} "
            "at the end",
            c.contact_Pa * 1e-6, c.piston_friction * 100.0, c.run_out * 100.0, c.warp * 100.0, (f[0] + f[1] + f[2]) * per_mean,
            (f[0] + 0.5 * f[1] + 0.25 * f[2]) * per_mean, f[0] * per_mean);
    }
    if (d.rig.brake_on_mps != plain.brake_on_mps) text += fmt::format(", {:.1f} m/s", d.rig.brake_on_mps);
    constexpr std::size_t kShown = 4;
    const auto& patches = d.rig.runway.patches;
    for (std::size_t i = 0; i < std::min(patches.size(), kShown); ++i)
        text += fmt::format(", {} from {:.0f} m", patches[i].surface.name, patches[i].from_m);
    if (patches.size() > kShown) text += fmt::format(", {} more", patches.size() - kShown);
    return text;
}

}  // namespace robust
