/// Eq. (8) against eq. (9) over whole closed-loop stops, locks and standstill included.
#include <algorithm>
#include <cmath>

#include "plant_sim/scenario/stop_options.hpp"
#include "plant_sim/study/in_process.hpp"
#include "tests/catch.hpp"

TEST_CASE("energy: the books of every closed-loop stop close to a millionth", "[RIG-050]") {
    double worst = 0.0;
    for (const std::string law : {"slip", "threshold"}) {
        for (const std::string& surface : rig::surface_names("config")) {
            for (const std::string& maneuver : rig::maneuver_names("config")) {
                plant_sim::StopOptions options;
                options.choice.surface = surface;
                options.choice.maneuver = maneuver;
                options.law = law;
                const plant_sim::StopInputs s = plant_sim::load_scenario(options);
                const study::RunResult result = study::run_in_process(s.controller, s.layout, s.plant.rig, s.session, study::Link::rounded);
                CAPTURE(law, surface, maneuver);
                CHECK(result.figures.standstill);
                CHECK(std::abs(result.figures.energy_residual) <= 1e-6);
                worst = std::max(worst, std::abs(result.figures.energy_residual));
            }
        }
    }
    SUCCEED("worst energy residual " << worst);
}
