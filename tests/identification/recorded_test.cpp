/// A maneuver in process leaves the log from which its samples can be read again.
#include "plant_sim/lab/recorded_run.hpp"

#include <cmath>

#include "plant_sim/endurance/frame_log.hpp"
#include "tests/catch.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/settings/refusal.hpp"

TEST_CASE("the bus log of a maneuver in process holds its samples", "[BRG-200]") {
    const endurance::EnduranceSetup setup = identification_test::setup("rejected_takeoff");
    const identification::Recording direct = identification_test::record(setup, 2);
    const TemporaryDirectory directory;
    endurance::TestCell cell = endurance_test::cell(setup, 2);
    endurance::FrameLog log(setup.layout, std::chrono::milliseconds(1), directory / "bus.log");
    REQUIRE(cell.run(rig::plan(setup.scenario, 2, 1), [&log](const endurance::Period& p) { log.add(p); }).phase == rig::Phase::finished);
    log.finish();
    const identification::Recording read = plant_sim::lab::read_recording(directory / "bus.log", setup.layout, 1e-3);
    REQUIRE(read.samples.size() == direct.samples.size());
    double force = 0.0;
    for (std::size_t i = 0; i + 1 < read.samples.size(); ++i) {
        const auto& a = read.samples[i];
        const auto& b = direct.samples[i];
        const bool same = std::abs(a.time_s - (b.time_s - direct.samples.front().time_s)) < 1e-9 && a.phase == b.phase &&
                          std::abs(a.current_mA - b.current_mA) < 1e-6 && std::abs(a.pressure_Pa - b.pressure_Pa) < 1.0 &&
                          std::abs(a.wheel.time_s - b.wheel.time_s) < 2e-7 && std::abs(a.flywheel.time_s - b.flywheel.time_s) < 2e-7 &&
                          a.cells_new == b.cells_new && std::abs(a.longitudinal_N - b.longitudinal_N) < 1e-3;
        CAPTURE(i, a.time_s, b.time_s, a.current_mA, b.current_mA, a.pressure_Pa, b.pressure_Pa);
        if (!same) FAIL("sample differs");
        if (i > 0) {
            CHECK(static_cast<std::uint16_t>(a.wheel.count - read.samples[i - 1].wheel.count) ==
                  static_cast<std::uint16_t>(b.wheel.count - direct.samples[i - 1].wheel.count));
        }
        force = std::max(force, a.longitudinal_N);
    }
    CHECK(force > 1e4);
    const std::string empty = (directory / "empty.log").string();
    put(empty, "");
    CHECK_THROWS_WITH(plant_sim::lab::read_recording(empty, setup.layout, 1e-3), ContainsSubstring("no sample"));
}

TEST_CASE("a log whose load cells end at the end of their field is no recording", "[STUDY-100]") {
    endurance::EnduranceSetup setup = identification_test::setup("rejected_takeoff");
    antiskid::can::Signal& field = setup.layout.load_cells.longitudinal_N;
    field.raw_max = field.raw(1e4);
    const TemporaryDirectory directory;
    endurance::TestCell cell = endurance_test::cell(setup, 2);
    endurance::FrameLog log(setup.layout, std::chrono::milliseconds(1), directory / "bus.log");
    static_cast<void>(cell.run(rig::plan(setup.scenario, 2, 1), [&log](const endurance::Period& p) { log.add(p); }));
    log.finish();
    CHECK_THROWS_WITH(plant_sim::lab::read_recording(directory / "bus.log", setup.layout, 1e-3),
                      ContainsSubstring("bus.log") && ContainsSubstring("longitudinal") && ContainsSubstring("10000 N"));
}
