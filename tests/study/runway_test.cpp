/// Whole stops on runways from files: what J_mu counts against, and what the trajectory says of it.
#include <cmath>
#include <sstream>

#include "plant_sim/study/stop_meter.hpp"
#include "plant_sim/study/trajectory.hpp"
#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"
#include "tests/study/scenarios.hpp"

namespace {

plant_sim::StopOptions on(const std::filesystem::path& runway, const std::string& law = "slip") {
    plant_sim::StopOptions o;
    o.config = scenarios::kConfig;
    o.choice.runway = runway;
    o.law = law;
    return o;
}

}  // namespace

TEST_CASE("on a wet runway J_mu counts against the friction available at each speed", "[STUDY-602]") {
    rig::RigParameters p = plant_sim::load_scenario(on("config/runways/wet_smooth.toml")).plant.rig;
    plant::Rig rig(p, 1e-3, 1);
    study::StopMeter meter(0.24, 5.0);
    rig.touch_down();
    rig.advance_pressure(20.7e6, 20.7e6);
    meter.start(rig);
    while (!rig.standstill()) {
        rig.advance_pressure(20.7e6, 20.7e6);
        meter.update(rig, 1e-3);
    }
    // A wheel that is locked all along has the same share of what is available at every speed.
    const rig::Surface& wet = p.runway.patches.front().surface;
    const double share = rig::friction(wet, 1.0).mu / rig::peak(wet).mu;
    CHECK(meter.figures(rig).j_mu == Approx(share).epsilon(1e-7));
    CHECK(std::abs(meter.figures(rig).energy_residual) < 1e-9);
}

TEST_CASE("the shipped wet runways in closed loop: books close, grooves stop earlier, J_mu stays below 1", "[STUDY-602][RIG-262]") {
    double smooth_m = 0.0;
    for (const std::string name : {"wet_smooth", "wet_grooved", "wet_middle"}) {
        INFO(name);
        const study::RunResult run = scenarios::run(on("config/runways/" + name + ".toml"));
        CHECK(run.came_to_rest);
        CHECK(run.faults.empty());
        CHECK(std::abs(run.figures.energy_residual) < 1e-9);
        CHECK(run.figures.j_mu > 0.9);
        CHECK(run.figures.j_mu < 1.0);
        if (name == "wet_smooth") smooth_m = run.figures.stop_distance_m;
        if (name == "wet_grooved") CHECK(run.figures.stop_distance_m < 0.85 * smooth_m);
    }
}

TEST_CASE("on a runway the trajectory has the place and what is available there; on one surface nothing more", "[STUDY-030]") {
    const auto csv_of = [](const plant_sim::StopOptions& o) {
        study::Trajectory rows(!o.choice.runway.empty());
        static_cast<void>(scenarios::run(
            o, study::Link::rounded,
            [&rows](const study::RigSession& session, const antiskid::can::ControllerView& view, double mA) { rows.record(session, view, mA); }));
        return std::string(rows.csv());
    };
    const std::string plain = csv_of(scenarios::options({"ice", "light"}));
    CHECK(plain.substr(0, plain.find('\n')).ends_with(",energy_tyre_J,state"));

    std::istringstream lines(csv_of(on("config/runways/wet_middle.toml")));
    std::string line;
    std::getline(lines, line);
    CHECK(line.ends_with(",state,runway_m,mu_max"));
    const rig::RigParameters rig = plant_sim::load_scenario(on("config/runways/wet_middle.toml")).plant.rig;
    int rows = 0;
    while (std::getline(lines, line)) {
        std::vector<std::string> cells;
        std::istringstream row(line);
        for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
        REQUIRE(cells.size() == 18);
        const double v = std::stod(cells[1]), F_z = std::stod(cells[10]), mu = std::stod(cells[12]);
        const double at_m = std::stod(cells[16]), mu_max = std::stod(cells[17]);
        if (F_z == 0.0) continue;  // in the air
        CHECK(std::abs(mu) <= mu_max + 1e-5);
        // The patch under the wheel changes with the step, up to 7 cm late.
        for (std::size_t i = 0; i < rig.runway.patches.size(); ++i) {
            const bool last = i + 1 == rig.runway.patches.size();
            if (at_m < rig.runway.patches[i].from_m + 0.07) continue;
            if (!last && at_m >= rig.runway.patches[i + 1].from_m) continue;
            CHECK(mu_max == Approx(rig::peak(rig.runway.patches[i].surface, v).mu).margin(1e-5));
            ++rows;
        }
    }
    CHECK(rows > 2000);
}
