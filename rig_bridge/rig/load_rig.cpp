#include "rig_bridge/rig/load_rig.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "firmware/host/settings/settings.hpp"
#include "rig_bridge/rig/load_compliance.hpp"
#include "rig_bridge/rig/load_runway.hpp"
#include "rig_bridge/wear/load_brake_wear.hpp"

namespace rig {

namespace {

using settings::Document;
using settings::Table;

constexpr std::array<std::string_view, 3> kFrictionClasses{"light", "medium", "heavy"};

Surface surface(const Table& t) {
    constexpr const char* kExpected = "expected c1, c2 and c3, or magic_formula = { B, C, D, E }";
    constexpr std::array<const char*, 3> kEquation4{"c1", "c2", "c3"};
    const auto* const key = std::ranges::find_if(kEquation4, [&t](const char* name) { return t.has(name); });
    const bool magic = t.has("magic_formula");
    if (magic && key != kEquation4.end()) t.fail(*key, std::string("stands beside 'magic_formula'; ") + kExpected);
    if (!magic && key == kEquation4.end()) t.fail("c1", std::string("missing; ") + kExpected);
    if (magic) {
        const Table m = t.table("magic_formula");
        return {.name = t.name(),
                .magic = MagicFormula{.B = m.number("B", {.min = 0.5, .max = 1000.0}),
                                      .C = m.number("C", {.min = 1.0, .max = 1.99}),
                                      .D = m.number("D", {.min = 1e-3, .max = 3.0}),
                                      .E = m.number("E", {.min = -10.0, .max = 1.0})}};
    }
    return {.name = t.name(),
            .c1 = t.number("c1", {.min = 1e-3, .max = 3.0}),
            .c2 = t.number("c2", {.min = 1.0, .max = 1000.0}),
            .c3 = t.number("c3", {.min = 0.0, .max = 3.0})};
}

std::vector<Surface> surfaces(const std::filesystem::path& path) {
    const Document doc = Document::load(path);
    std::vector<Surface> all;
    for (const Table& t : doc.root().table("surfaces").tables()) all.push_back(surface(t));
    doc.finish();
    return all;
}

struct Maneuver {
    std::string name;
    double mass_kg = 0.0;
    double speed_mps = 0.0;
    std::size_t friction_class = 0;
};

std::size_t friction_class(const Table& t) {
    static constexpr std::array<settings::Choice<std::size_t>, 3> kChoices{
        {{kFrictionClasses[0], 0}, {kFrictionClasses[1], 1}, {kFrictionClasses[2], 2}}};
    return t.choice<std::size_t>("friction_class", kChoices);
}

constexpr settings::Range kMass_kg{.min = 100.0, .max = 1e5};
constexpr settings::Range kSpeed_mps{.min = 1.0, .max = 120.0};

template <typename Named>
std::vector<std::string> names(const std::vector<Named>& all) {
    std::vector<std::string> list;
    list.reserve(all.size());
    for (const Named& one : all) list.push_back(one.name);
    return list;
}

/// Checks that the key's word is one of `known`.
void check_name(const Table& t, std::string_view key, const std::vector<std::string>& known) {
    const std::string word = t.text(key);
    if (std::find(known.begin(), known.end(), word) == known.end())
        t.fail(key, fmt::format("unknown {} '{}'; there are {}", key, word, fmt::join(known, ", ")));
}

std::vector<Maneuver> maneuvers(const std::filesystem::path& path, const std::vector<Surface>& runways) {
    const Document doc = Document::load(path);
    std::vector<Maneuver> all;
    for (const Table& t : doc.root().table("maneuvers").tables()) {
        all.push_back({.name = t.name(),
                       .mass_kg = t.number("mass_kg", kMass_kg),
                       .speed_mps = t.number("speed_mps", kSpeed_mps),
                       .friction_class = friction_class(t)});
    }
    const Table reference = doc.root().table("reference");
    check_name(reference, "maneuver", names(all));
    check_name(reference, "surface", names(runways));
    (void)reference.number("slip_reference", {.min = 0.0, .max = 0.5});
    doc.finish();
    return all;
}

EncoderParameters encoder(const Table& t) {
    return {.teeth = static_cast<double>(t.integer("teeth", {.min = 1, .max = 10000})),
            .jitter_s = t.number("jitter_us", {.min = 0.0, .max = 1000.0}) * 1e-6,
            .slowest_edges_hz = t.number("slowest_edges_Hz", {.min = 0.0, .max = 1000.0}),
            .pitch_error = t.find_number("pitch_error", {.min = 0.0, .max = 0.3}).value_or(0.0),
            .eccentricity = t.find_number("eccentricity", {.min = 0.0, .max = 0.1}).value_or(0.0)};
}

WheelParameters wheel(const Table& t) {
    return {.mass_kg = 0.0,
            .inertia_kgm2 = t.number("inertia_kgm2", {.min = 0.01, .max = 100.0}),
            .free_radius_m = t.number("free_radius_m", {.min = 0.05, .max = 2.0}),
            .stiffness_Npm = t.number("stiffness_Npm", {.min = 1e4, .max = 1e9})};
}

BrakeGeometry brake(const Table& t) {
    return {.piston_area_m2 = t.number("piston_area_m2", {.min = 1e-6, .max = 1.0}),
            .pistons = static_cast<double>(t.integer("pistons", {.min = 1, .max = 100})),
            .surfaces = static_cast<double>(t.integer("surfaces", {.min = 1, .max = 100})),
            .effective_radius_m = t.number("effective_radius_m", {.min = 0.01, .max = 2.0})};
}

Clamping clamping(const Table& brake) {
    const std::optional<Table> t = brake.find_table("clamping");
    if (!t) return {};
    constexpr settings::Range kShare{.min = 0.0, .max = 0.45};
    return {.contact_Pa = t->number("contact_Pa", {.min = 0.0, .max = 1e7}),
            .piston_friction = t->number("piston_friction", kShare),
            .run_out = t->number("run_out", kShare),
            .warp = t->number("warp", kShare)};
}

/// Curve of one class relative to its mean.
FrictionCurve relative_curve(const Table& t, std::string_view name) {
    FrictionCurve curve{};
    const auto c = t.numbers(name, {.range = {.min = -10.0, .max = 10.0}, .count = {.min = curve.size(), .max = curve.size()}});
    std::copy(c.begin(), c.end(), curve.begin());
    if (min_friction(curve, 1.0) <= 0.0) t.fail(name, "falls to zero within the stop; mu_b must stay positive");
    return curve;
}

FrictionCurve scaled(FrictionCurve curve, double friction) {
    for (double& c : curve) c *= friction;
    return curve;
}

/// Reads all classes, so that a mistake in any of them is reported; returns the chosen one times the new brake's friction.
FrictionCurve friction_curve(const Table& t, std::size_t chosen, double friction) {
    std::array<FrictionCurve, kFrictionClasses.size()> curves{};
    for (std::size_t i = 0; i < curves.size(); ++i) curves[i] = relative_curve(t, kFrictionClasses[i]);
    return scaled(curves[chosen], friction);
}

/// The chosen class of a file that may lack classes; `otherwise` if it lacks this one.
FrictionCurve learnt_curve(const std::filesystem::path& path, std::size_t chosen, double friction, const FrictionCurve& otherwise) {
    const Document doc = Document::load(path);
    const Table t = doc.root().table("brake").table("relative_friction");
    FrictionCurve out = otherwise;
    bool any = false;
    for (std::size_t i = 0; i < kFrictionClasses.size(); ++i) {
        if (!t.has(kFrictionClasses[i])) continue;
        any = true;
        const FrictionCurve curve = relative_curve(t, kFrictionClasses[i]);
        if (i == chosen) out = scaled(curve, friction);
    }
    doc.finish();
    if (!any) t.fail("", "has no class; expected one or more of light, medium, heavy");
    return out;
}

PressureMap pressure_map(const Table& t) {
    const auto current =
        t.numbers("current_mA", {.range = {.min = 0.0, .max = 1000.0}, .count = {.min = 2, .max = 1000}, .strictly_increasing = true});
    const auto pressure = t.numbers("pressure_Pa", {.range = {.min = 0.0, .max = 1e8}, .count = {.min = 2, .max = 1000}});
    if (pressure.size() != current.size()) t.fail("pressure_Pa", "needs as many points as current_mA");
    std::vector<PressureMap::Point> points;
    points.reserve(current.size());
    for (std::size_t i = 0; i < current.size(); ++i) {
        if (i > 0 && pressure[i] < pressure[i - 1]) t.fail("pressure_Pa", "must not fall from one point to the next");
        points.push_back({current[i], pressure[i]});
    }
    return PressureMap(std::move(points));
}

ValveParameters valve(const Table& t) {
    return {.natural_frequency_radps = 2.0 * std::numbers::pi * t.number("natural_frequency_Hz", {.min = 1.0, .max = 100.0}),
            .damping = t.number("damping", {.min = 0.05, .max = 0.99}),
            .delay_s = t.number("delay_ms", {.min = 0.0, .max = 100.0}) * 1e-3,
            .hysteresis_mA = t.find_number("hysteresis_mA", {.min = 0.0, .max = 20.0}).value_or(0.0),
            .line_s = t.find_number("line_ms", {.min = 0.0, .max = 1000.0}).value_or(0.0) * 1e-3};
}

TransducerParameters transducer(const Table& t) {
    return {.range_Pa = t.number("range_Pa", {.min = 1e5, .max = 1e9}),
            .noise_Pa = t.number("noise_Pa", {.min = 0.0, .max = 1e7}),
            .resolution_Pa = t.number("resolution_Pa", {.min = 0.0, .max = 1e7})};
}

/// Reads the tables common to both rigs: brake, valve, sensors, wheel.
RigParameters common_parts(const Table& root, std::size_t friction_class, const Surface& runway) {
    const Table brake_table = root.table("brake");
    const double friction = brake_table.number("friction", {.min = 0.01, .max = 1.0});
    const Table valve_table = root.table("valve");
    const Table wheel_table = root.table("wheel");
    const Table flywheel = root.table("flywheel");
    WheelParameters rolling = wheel(wheel_table);
    rolling.compliance = load_tyre(root);
    return {.wheel = rolling,
            .load = {},
            .brake = brake(brake_table),
            .clamping = clamping(brake_table),
            .friction_curve = friction_curve(brake_table.table("relative_friction"), friction_class, friction),
            .mean_friction = friction,
            .valve = valve(valve_table),
            .pressure_map = pressure_map(valve_table),
            .wheel_encoder = encoder(wheel_table.table("encoder")),
            .flywheel_encoder = encoder(flywheel.table("encoder")),
            .flywheel_radius_m = flywheel.number("radius_m", {.min = 0.05, .max = 10.0}),
            .transducer = transducer(root.table("pressure_transducer")),
            .surface = runway,
            .brake_on_mps = 0.0};
}

/// The path of the model's file is relative to the rig's file.
wear::BrakeWear wear_of(const Table& root, const std::filesystem::path& rig_file) {
    return wear::load_brake_wear(root.table("brake").table("wear"), rig_file.parent_path());
}

double loading_lag_s(const Table& root) {
    return root.table("loading_device").number("lag_ms", {.min = 0.0, .max = 10000.0}) * 1e-3;
}

/// Checks that r(F_z) stays positive.
void check_radius(const Table& root, const WheelParameters& wheel, double load_N) {
    if (load_N < 0.5 * wheel.free_radius_m * wheel.stiffness_Npm) return;
    root.table("wheel").fail("stiffness_Npm",
                             std::to_string(load_N) + " N flatten the tyre by half its free radius or more; expected a stiffer tyre or less load");
}

struct Landing {
    RigParameters rig;
    wear::BrakeWear wear;
    double drop_out_mps;
};

Landing landing(const std::filesystem::path& path, const Maneuver& maneuver, const Surface& runway) {
    const Document doc = Document::load(path);
    const Table root = doc.root();
    Landing landing{common_parts(root, maneuver.friction_class, runway), wear_of(root, path),
                    root.table("evaluation").number("drop_out_mps", {.min = 0.1, .max = 50.0})};
    const Table environment = root.table("environment");
    const double rho = environment.number("air_density_kgpm3", {.min = 0.0, .max = 2.0});
    const double g = environment.number("gravity_mps2", {.min = 1.0, .max = 20.0});
    const Table aircraft = root.table("aircraft");
    const double lift = 0.5 * rho * aircraft.number("lift_area_m2", {.min = 0.0, .max = 1000.0});
    const double weight = maneuver.mass_kg * g;
    if (lift * maneuver.speed_mps * maneuver.speed_mps >= weight) {
        aircraft.fail("lift_area_m2", "lifts " + std::to_string(maneuver.mass_kg) + " kg off the ground at " + std::to_string(maneuver.speed_mps) +
                                          " m/s: F_z of eq. (2) must stay above zero");
    }
    check_radius(root, landing.rig.wheel, weight);
    landing.rig.wheel.compliance.leg = load_leg(root, maneuver.mass_kg);
    doc.finish();
    landing.rig.wheel.mass_kg = maneuver.mass_kg;
    landing.rig.load = {.base_N = weight, .lift_Ns2pm2 = lift, .lag_s = 0.0};
    landing.rig.brake_on_mps = maneuver.speed_mps;
    return landing;
}

/// The flywheel spins up the wheel: r (m v_t - m v_b) = J v_b / r.
double before_spin_up_mps(const RigParameters& rig) {
    const WheelParameters& w = rig.wheel;
    const double r = w.free_radius_m - rig.load.base_N / w.stiffness_Npm;
    return rig.brake_on_mps * (1.0 + w.inertia_kgm2 / (w.mass_kg * r * r));
}

struct FlywheelRig {
    RigParameters rig;
    wear::BrakeWear wear;
    std::size_t friction_class;
    double deceleration_mps2;
    double lag_s;
};

FlywheelRig flywheel_rig(const std::filesystem::path& path, const Surface& runway) {
    const Document doc = Document::load(path);
    const Table root = doc.root();
    const Table test = root.table("endurance");
    const std::size_t chosen = friction_class(test);
    FlywheelRig out{common_parts(root, chosen, runway), wear_of(root, path), chosen, test.number("deceleration_mps2", {.min = 0.1, .max = 20.0}),
                    loading_lag_s(root)};
    const double inertia = root.table("flywheel").number("inertia_kgm2", {.min = 0.1, .max = 1e6});
    out.rig.wheel.mass_kg = inertia / (out.rig.flywheel_radius_m * out.rig.flywheel_radius_m);
    out.rig.load = {.base_N = test.number("load_N", {.min = 100.0, .max = 1e6}), .lift_Ns2pm2 = 0.0, .lag_s = out.lag_s};
    out.rig.brake_on_mps = test.number("speed_mps", kSpeed_mps);
    // Scatter and acceptance figures of the campaign: read only to report mistakes; the program that runs it uses them.
    (void)test.integer("maneuvers", {.min = 1, .max = 1000000});
    for (const char* key : {"speed_deviation_mps", "load_deviation_N", "torque_Nm", "torque_deviation_Nm", "duration_s", "duration_deviation_s",
                            "length_m", "length_deviation_m"}) {
        (void)test.number(key, {.min = 0.0, .max = 1e6});
    }
    check_radius(root, out.rig.wheel, out.rig.load.base_N);
    doc.finish();
    return out;
}

template <typename Named>
const Named& find(const std::vector<Named>& all, const std::string& name, const char* what, const std::filesystem::path& file,
                  const std::string& more = {}) {
    for (const Named& one : all) {
        if (one.name == name) return one;
    }
    throw settings::Error(file.string(), 0, what, fmt::format("unknown {} '{}'; there are {}{}", what, name, fmt::join(names(all), ", "), more));
}

void override_with(const std::optional<double>& value, const settings::Range& range, const char* what, double& target) {
    if (!value) return;
    if (!(*value >= range.min && *value <= range.max)) {
        throw std::invalid_argument(std::string(what) + ": " + std::to_string(*value) + " is out of range " + std::to_string(range.min) + " to " +
                                    std::to_string(range.max));
    }
    target = *value;
}

}  // namespace

LoadedRig load_rig(const std::filesystem::path& directory, const ManeuverChoice& choice) {
    const auto surface_file = directory / "surfaces.toml";
    const auto maneuver_file = directory / "maneuvers.toml";
    const auto landing_file = directory / "landing_gear.toml";
    const auto flywheel_file = directory / "flywheel_rig.toml";
    const std::vector<Surface> known_surfaces = surfaces(surface_file);
    const Runway runway = choice.runway.empty() ? Runway{} : load_runway(choice.runway, known_surfaces);
    const Surface road = choice.runway.empty() ? find(known_surfaces, choice.surface, "surface", surface_file) : runway.patches.front().surface;
    const std::vector<Maneuver> known = maneuvers(maneuver_file, known_surfaces);
    const FlywheelRig bench = flywheel_rig(flywheel_file, road);
    Maneuver maneuver =
        choice.maneuver == kEndurance ? known.front() : find(known, choice.maneuver, "maneuver", maneuver_file, std::string(", ") + kEndurance);
    if (choice.maneuver == kEndurance) {
        maneuver.mass_kg = bench.rig.wheel.mass_kg;
        maneuver.speed_mps = bench.rig.brake_on_mps;
    }
    override_with(choice.mass_kg, kMass_kg, "mass", maneuver.mass_kg);
    override_with(choice.speed_mps, kSpeed_mps, "speed", maneuver.speed_mps);

    const std::size_t chosen = choice.maneuver == kEndurance ? bench.friction_class : maneuver.friction_class;
    LoadedRig out{.rig = bench.rig,
                  .friction_class = std::string(kFrictionClasses[chosen]),
                  .wear = bench.wear,
                  .files = {surface_file, maneuver_file, landing_file, flywheel_file}};
    const Landing gear = landing(landing_file, choice.maneuver == kEndurance ? known.front() : maneuver, road);
    out.drop_out_mps = gear.drop_out_mps;
    if (choice.maneuver == kEndurance) {
        out.deceleration_mps2 = bench.deceleration_mps2;
        out.rig.wheel.mass_kg = maneuver.mass_kg;
        out.rig.brake_on_mps = maneuver.speed_mps;
        out.rig.touchdown_mps = before_spin_up_mps(out.rig);
    } else {
        out.rig = gear.rig;
        out.wear = gear.wear;
        if (choice.carrier == Carrier::flywheel) {
            out.rig.load.lag_s = bench.lag_s;
            out.rig.wheel.compliance.leg = {};  // the sledge carries the wheel
        }
    }
    if (!choice.runway.empty()) {
        out.rig.runway = runway;
        out.files.push_back(choice.runway);
    }
    if (!choice.friction_curves.empty()) {
        out.rig.friction_curve = learnt_curve(choice.friction_curves, chosen, out.rig.mean_friction, out.rig.friction_curve);
        out.files.push_back(choice.friction_curves);
    }
    override_with(choice.friction, {.min = 0.01, .max = 1.0}, "mu_b", out.rig.mean_friction);
    if (min_friction(out.rig.friction_curve, out.rig.mean_friction) <= 0.0) {
        throw std::invalid_argument("mu_b: a mean of " + std::to_string(out.rig.mean_friction) +
                                    " takes the friction curve of this maneuver below zero; expected a larger one");
    }
    out.files.push_back(out.wear.file);
    out.full_pressure_Pa = out.rig.pressure_map.points().back().pressure_Pa;
    return out;
}

std::vector<std::string> friction_class_names() {
    return {kFrictionClasses.begin(), kFrictionClasses.end()};
}

std::vector<std::string> surface_names(const std::filesystem::path& directory) {
    return names(surfaces(directory / "surfaces.toml"));
}

std::vector<std::string> maneuver_names(const std::filesystem::path& directory) {
    return names(maneuvers(directory / "maneuvers.toml", surfaces(directory / "surfaces.toml")));
}

}  // namespace rig
