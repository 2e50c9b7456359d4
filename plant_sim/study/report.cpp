#include "plant_sim/study/report.hpp"

#include <fmt/format.h>

#include "firmware/can/names.hpp"
#include "firmware/host/settings/json.hpp"
#include "plant_sim/study/json_number.hpp"

namespace study {

std::string to_json(const StopReport& r) {
    const StopFigures& f = r.figures;
    const settings::Json json{
        {"maneuver", r.maneuver},
        {"surface", r.surface},
        {"law", r.law},
        {"slip_reference", r.slip_reference},
        {"mass_kg", r.mass_kg},
        {"speed_mps", r.speed_mps},
        {"brake_taken_J", or_null(r.brake_taken_J)},
        {"standstill", f.standstill},
        {"stop_distance_m", f.stop_distance_m},
        {"duration_s", f.duration_s},
        {"j_mu", f.j_mu},
        {"slip_efficiency", f.slip_efficiency},
        {"energy_brake_J", f.energy_brake_J},
        {"energy_tyre_J", f.energy_tyre_J},
        {"energy_residual", f.energy_residual},
        {"peak_slip", f.peak_slip},
        {"tracked_share", or_null(f.tracked_share)},
        {"tracked_tyre_share", or_null(f.tracked_tyre_share)},
        {"longest_lock_s", f.longest_lock_s},
        {"mean_friction", f.mean_friction},
        {"mean_torque_Nm", f.mean_torque_Nm},
        {"mean_load_N", f.mean_load_N},
        {"valve_travel_mAps", or_null(f.valve_travel_mAps)},
        {"faults", antiskid::can::fault_names(r.faults)},
        {"frames_sent", r.frames_sent},
        {"frames_received", r.frames_received},
        {"frames_lost", r.frames_lost},
        {"overruns", r.overruns},
        {"seed", r.seed},
        {"version", r.version},
        {"config_hash", r.config_hash},
    };
    return settings::json_page(json);
}

std::string to_table(const StopReport& r) {
    const StopFigures& f = r.figures;
    std::string t = fmt::format("{} landing, {:.0f} kg at {:.1f} m/s on {}, law {}, slip reference {:.2f}\n", r.maneuver, r.mass_kg, r.speed_mps,
                                r.surface, r.law, r.slip_reference);
    const auto row = [&t](const char* what, const std::string& value, const char* unit) {
        t += fmt::format("  {:<34} {:>12} {}\n", what, value, unit);
    };
    row(f.standstill ? "stop distance" : "distance (did not come to rest)", fmt::format("{:.1f}", f.stop_distance_m), "m");
    row("time from brake-on", fmt::format("{:.2f}", f.duration_s), "s");
    row("J_mu, eq. (16)", fmt::format("{:.4f}", f.j_mu), "");
    row("wheel-slip efficiency", fmt::format("{:.4f}", f.slip_efficiency), "");
    row("energy to the brake", fmt::format("{:.3f}", f.energy_brake_J * 1e-6), "MJ");
    if (r.brake_taken_J) row("that it had taken before", fmt::format("{:.3f}", *r.brake_taken_J * 1e-6), "MJ");
    row("energy to the tyre", fmt::format("{:.3f}", f.energy_tyre_J * 1e-6), "MJ");
    row("energy residual, eq. (8) - (9)", fmt::format("{:.1e}", f.energy_residual), "of the total");
    row("peak slip above drop-out", fmt::format("{:.3f}", f.peak_slip), "");
    row("longest lock above drop-out", fmt::format("{:.0f}", f.longest_lock_s * 1e3), "ms");
    row("distance within 0.05 of reference", f.tracked_share ? fmt::format("{:.1f}", *f.tracked_share * 100.0) : "not measured",
        f.tracked_share ? "% (from 0.5 s down to 20 m/s)" : "(from 0.5 s down to 20 m/s)");
    row("mean brake friction, eq. (7)", fmt::format("{:.4f}", f.mean_friction), "");
    row("valve travel above drop-out", f.valve_travel_mAps ? fmt::format("{:.0f}", *f.valve_travel_mAps) : "not measured",
        f.valve_travel_mAps ? "mA/s" : "");
    row("frames sent / received / lost", fmt::format("{} / {} / {}", r.frames_sent, r.frames_received, r.frames_lost), "");
    row("periods missed by the rig", fmt::format("{}", r.overruns), "");
    row("faults", r.faults.empty() ? "none" : fmt::format("{}", fmt::join(antiskid::can::fault_names(r.faults), ", ")), "");
    t += fmt::format("  seed {}, configuration {}, version {}\n", r.seed, r.config_hash, r.version);
    return t;
}

}  // namespace study
