#include "plant_sim/plc/load_served_rig.hpp"

#include "firmware/host/settings/settings.hpp"

namespace plc {

namespace {

using settings::Document;
using settings::Table;

Drive drive(const Table& t) {
    return {.torque_Nm = t.number("torque_Nm", {.min = 1.0, .max = 1e6}),
            .power_W = t.number("power_W", {.min = 100.0, .max = 1e8}),
            .speed_max_mps = t.number("speed_max_mps", {.min = 1.0, .max = 200.0}),
            .response_s = t.number("response_s", {.min = 0.01, .max = 60.0}),
            .drag = {.bearing_N = t.number("bearing_drag_N", {.min = 1e-3, .max = 1e5}),
                     .windage_Ns2pm2 = t.number("windage_Ns2pm2", {.min = 1e-6, .max = 100.0})}};
}

Sledge sledge(const Table& t) {
    return {.contact_m = t.number("contact_m", {.min = 0.01, .max = 10.0}),
            .speed_mps = t.number("speed_mps", {.min = 1e-3, .max = 10.0}),
            .wheel_drag_Nm = t.number("wheel_drag_Nm", {.min = 1e-3, .max = 1e4})};
}

LoadingDevice loading(const Table& t) {
    LoadingDevice device{.force_max_N = t.number("force_max_N", {.min = 1.0, .max = 1e7}),
                         .lift_max_Ns2pm2 = t.number("lift_max_Ns2pm2", {.min = 0.0, .max = 1e4})};
    device.contact_force_N = t.number("contact_force_N", {.min = 1.0, .max = device.force_max_N});
    return device;
}

BrakeThermal thermal(const Table& t) {
    return {.heat_capacity_JpK = t.number("heat_capacity_JpK", {.min = 1.0, .max = 1e8}),
            .cooling_WpK = t.number("cooling_WpK", {.min = 1e-3, .max = 1e6}),
            .ambient_C = t.number("ambient_C", {.min = -60.0, .max = 80.0})};
}

Gauge gauge(const Table& t, const char* noise, const char* resolution, double max) {
    return {.noise = t.number(noise, {.min = 0.0, .max = max}), .resolution = t.number(resolution, {.min = 1e-9, .max = max})};
}

/// Both benches are read, so that a mistake in either shows.
Machinery bench(const Table& t) {
    const Table cells = t.table("cells");
    const Table supply = t.table("hydraulics");
    return {.drive = drive(t.table("drive")),
            .sledge = sledge(t.table("sledge")),
            .loading = loading(t.table("loading_device")),
            .thermal = thermal(t.table("brake_thermal")),
            .gauges = {.force = gauge(cells, "force_noise_N", "force_resolution_N", 1e5),
                       .torque = gauge(cells, "torque_noise_Nm", "torque_resolution_Nm", 1e5),
                       .speed = gauge(cells, "speed_noise_mps", "speed_resolution_mps", 10.0),
                       .temperature = gauge(t.table("brake_thermal"), "noise_C", "resolution_C", 100.0),
                       .hydraulics = gauge(supply, "noise_Pa", "resolution_Pa", 1e7)},
            .hydraulics = {.pressure_Pa = supply.number("pressure_Pa", {.min = 1e5, .max = 1e8}),
                           .ready_Pa = supply.number("ready_Pa", {.min = 1e4, .max = 1e8})}};
}

}  // namespace

std::filesystem::path machinery_file(const std::filesystem::path& directory) {
    return directory / "rig_machinery.toml";
}

ServedRigOptions load_served_rig(const std::filesystem::path& directory, Bench which) {
    const Document doc = Document::load(machinery_file(directory));
    const Machinery landing = bench(doc.root().table("landing"));
    const Machinery endurance = bench(doc.root().table("endurance"));
    doc.finish();
    return {.machinery = which == Bench::landing ? landing : endurance, .brake = {}};
}

}  // namespace plc
