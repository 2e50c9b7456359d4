/// Recordings made from the plant's true state, and their import.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "firmware/host/controller_config.hpp"
#include "rig_bridge/replay/campaign_table.hpp"
#include "rig_bridge/replay/importer.hpp"
#include "rig_bridge/rig/meter_parameters.hpp"
#include "rig_bridge/rig/scenario.hpp"
#include "tests/replay/landings.hpp"

namespace replay_test {

struct Row {
    double time_s, wheel_radps, v_mps, pressure_Pa, load_N, torque_Nm, current_mA;
};

/// Every 2 ms of an endurance stop, from rolling to the release.
struct Truth {
    Truth() {
        auto options = scenarios::options({"dry_asphalt", "endurance"}, "deceleration");
        std::int64_t step = 0;
        const auto result = scenarios::run(
            options, study::Link::rounded, [&](const study::RigSession& session, const antiskid::can::ControllerView&, double current_mA) {
                const plant::Rig& rig = session.rig();
                const plant::Forces f = rig.forces();
                if (++step % 2 == 0 && rig.time_s() > 1.2)
                    rows.push_back(
                        {rig.time_s(), rig.wheel().omega_radps, rig.wheel().v_mps, rig.pressure_Pa(), f.F_z_N, f.brake_torque_Nm, current_mA});
            });
        figures = result.figures;
    }
    std::vector<Row> rows;
    study::StopFigures figures;
};

inline const Truth& truth() {
    static const Truth kTruth;
    return kTruth;
}

inline std::string german(double value, int decimals) {
    std::string text = fmt::format("{:.{}f}", value, decimals);
    std::replace(text.begin(), text.end(), '.', ',');
    return text;
}

inline const std::string kHead = "Pruefstand 3;;;;;\nZeit;n_Rad;v_Schwungrad;p_Bremse;F_z;M_Bremse\ns;1/min;km/h;bar;kN;Nm\n";

/// `pressure`: from Pa to what the column has.
inline std::string csv_row(const Row& r, double shift_s, double pressure = 1e-5) {
    return fmt::format("{};{};{};{};{};{}\n", german(r.time_s + shift_s, 4), german(r.wheel_radps * 30.0 / std::numbers::pi, 4),
                       german(r.v_mps * 3.6, 5), german(r.pressure_Pa * pressure, 4), german(r.load_N * 1e-3, 4), german(r.torque_Nm, 3));
}

/// Two stops one after the other.
inline std::string two_stops(double pressure = 1e-5, const std::array<double, 2>& shifts_s = {0.0, 30.0}) {
    std::string csv = kHead;
    for (const double shift_s : shifts_s)
        for (const Row& row : truth().rows) csv += csv_row(row, shift_s, pressure);
    return csv;
}

struct Import {
    Import(const std::filesystem::path& file, const rig::replay::ImportMap& with, const rig::record::Specimen& specimen = {}) : map(with) {
        const rig::replay::ImportSettings settings{
            .file = file,
            .map = map,
            .out = out,
            .rig = {.layout = can_test::ours(), .meter = meter, .plan = scenario.mean, .with_valve = map.channels[6].has_value(), .number = 0},
            .specimen = specimen,
            .config_hash = "x"};
        rig::replay::ImportNotes notes("r.csv", [this](const std::string& text) { said += text + "\n"; });
        report = rig::replay::import_recording(settings, notes);
        counts = notes.counts();
    }
    /// The campaign from its logs.
    [[nodiscard]] rig::replay::CampaignTable rebuilt() const {
        const rig::replay::CampaignSources sources{.layout = can_test::ours(),
                                                   .parameters = [&](const std::string&) { return meter; },
                                                   .ledger = {},
                                                   .with_ledger = false,
                                                   .warnings = [](const std::string& name) { return rig::replay::LogWarnings(name, {}); }};
        return rig::replay::rebuild_campaign(rig::replay::maneuver_folders(out), sources);
    }
    TempDir dir;
    rig::Scenario scenario = rig::load_scenario("config/scenarios/endurance.toml");
    rig::record::MeterParameters meter = rig::meter_parameters(scenario, antiskid::load_controller_config(scenario.controller));
    std::filesystem::path out = dir.write("x", "").parent_path() / "night";
    rig::replay::ImportMap map;
    rig::replay::ImportReport report;
    std::string said;
    std::map<std::string, std::uint64_t> counts;
};

inline rig::replay::ImportMap example() {
    return rig::replay::load_import_map("config/import_example.toml");
}

}  // namespace replay_test
