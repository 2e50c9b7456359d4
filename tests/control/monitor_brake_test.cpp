// The checks of pressure and brake by themselves: on which side of each limit a fault begins.
#include <cmath>

#include "tests/catch.hpp"
#include "tests/control/watch.hpp"

using namespace antiskid::control;
using control_test::exact_config;
using control_test::fixed_config;
using control_test::kExact_s;
using control_test::kMillisecond;
using control_test::Watch;

TEST_CASE("pressure without a current is named armed, or on a loaded or rolling wheel, alone", "[CTL-081]") {
    struct Row {
        bool on_wheels, moves, rolling, armed;
        float pressure_Pa;
        bool named;
    };
    const Row row = GENERATE(values<Row>({{true, false, false, false, 0.6e6F, false},
                                          {false, true, false, false, 0.6e6F, false},
                                          {true, true, false, false, 0.6e6F, true},
                                          {false, false, true, false, 0.6e6F, true},
                                          {false, false, false, true, 0.6e6F, true},
                                          {true, true, true, true, 0.5e6F, false}}));
    Watch w;
    w.previous.rolling = row.rolling;
    w.sensors.maneuver.weight_on_wheels = row.on_wheels;
    w.sensors.maneuver.arm = row.armed;
    w.sensors.flywheel.speed_radps = row.moves ? 50.0F : 0.0F;
    w.sensors.pressure.pressure_Pa = row.pressure_Pa;
    FaultSet all;
    for (int k = 0; k < 150; ++k) all.insert(w.step());
    CHECK(all.contains(Fault::pressure_off_command) == row.named);
}

TEST_CASE("a sensor that starts late with one pascal is not stuck", "[CTL-081]") {
    Watch w;
    w.current_mA = 9.0F;
    for (int k = 0; k < 300; ++k) {
        w.now += kMillisecond;
        w.silent_step();
    }
    w.sensors.pressure.pressure_Pa = 1.0F;
    for (int k = 0; k < 300; ++k) REQUIRE_FALSE(w.step().contains(Fault::pressure_stuck));
}

namespace {

/// What is said of a rolling wheel in the period in which the valve's model, under 5 mA, is exactly at `model_Pa`.
FaultSet faults_at(const float model_Pa, const float reading_Pa, const float wheel_radps) {
    Config config = exact_config();
    config.monitor.off_command_s = kExact_s;
    config.monitor.free_slip = 0.25F;
    // A map a little lower each time, until a rounded value of the model is the one that is asked for.
    float mapped_Pa = model_Pa;
    for (int tries = 0; tries < 600; ++tries) {
        config.valve.pressure_Pa[1] = mapped_Pa;
        Watch w(config);
        w.previous.rolling = true;
        w.current_mA = 5.0F;
        w.sensors.flywheel.speed_radps = 128.0F;
        w.sensors.wheel.speed_radps = wheel_radps;
        w.sensors.pressure.pressure_Pa = reading_Pa;
        for (int k = 0; k < 300; ++k) {
            const FaultSet faults = w.step();
            if (k > 100 && w.estimator.uncorrected_pressure_Pa() == model_Pa) return faults;
        }
        mapped_Pa = std::nextafter(mapped_Pa, 0.0F);
    }
    FAIL("no map brings the model to " << model_Pa);
    return {};
}

}  // namespace

TEST_CASE("a model exactly at the pressure that counts as released, or as hardly braked, does not", "[CTL-081]") {
    const bool below = GENERATE(false, true);
    const auto at = [below](const float limit) { return below ? std::nextafter(limit, 0.0F) : limit; };
    const FaultSet released = faults_at(at(2e4F), 0.6e6F, 128.0F);
    CHECK(released.contains(Fault::pressure_off_command) == below);
    const FaultSet hardly_braked = faults_at(at(1e5F), 1e5F, 90.0F);
    CHECK(hardly_braked.contains(Fault::speeds_disagree) == below);
}

TEST_CASE("a wheel that changes its speed by 15 m/s2 is not steady", "[CTL-081]") {
    const float max_radps2 = GENERATE(30.0F, 29.9F);  // at radii of 0.5 m
    Config config = exact_config();
    config.wheel.encoder.max_acceleration_radps2 = max_radps2;  // what the observer stops at
    config.observer.pole_floor_radps = 0.0F;                    // a road without a slope
    config.monitor.free_slip = 0.25F;
    Watch w(config);
    w.sensors.flywheel.speed_radps = 128.0F;
    w.sensors.wheel.speed_radps = 90.0F;
    for (int k = 0; k < 200; ++k) {
        w.sensors.wheel.speed_radps -= 0.05F;  // 51 rad/s2
        w.step();
    }
    REQUIRE(w.estimator.estimate().omega_dot_radps2 == -max_radps2);
    w.previous.rolling = true;
    w.sensors.wheel.speed_radps -= 0.05F;
    CHECK(w.step().contains(Fault::speeds_disagree) == (max_radps2 < 30.0F));
}

TEST_CASE("a wheel that loses more than the brake can take is named, one that the brake slows is not", "[CTL-081]") {
    struct Row {
        float pressure_Pa, share;  // of the speed that is left at once
        bool rolling, named;
    };
    const Row row = GENERATE(values<Row>({{0.0F, 0.86F, true, false},
                                          {0.0F, 0.82F, true, true},
                                          {0.0F, 0.5F, true, true},
                                          {0.0F, 0.0F, true, true},
                                          {0.0F, 0.5F, false, false},
                                          {12e6F, 0.7F, true, false}}));
    CAPTURE(row.pressure_Pa, row.share, row.rolling);
    Config config = fixed_config();
    config.monitor.off_command_Pa = 1e9F;
    config.monitor.free_slip = 1.0F;
    Watch w(config);
    w.previous.rolling = row.rolling;
    const float v_mps = 60.0F;
    w.sensors.flywheel.speed_radps = v_mps / config.flywheel.radius_m;
    w.sensors.pressure.pressure_Pa = row.pressure_Pa;
    w.sensors.wheel.speed_radps = 170.0F;
    for (int k = 0; k < 300; ++k) w.step();
    w.sensors.wheel.speed_radps *= row.share;
    FaultSet all;
    for (int k = 0; k < 8; ++k) all.insert(w.step());
    CHECK((all.contains(Fault::speeds_disagree) || all.contains(Fault::wheel_stuck)) == row.named);
    if (row.named) CHECK(all.contains(Fault::wheel_stuck) == (row.share == 0.0F));
}

TEST_CASE("what the road has wound up in a carcass may swing back, a wheel that rolled with the aircraft may not", "[CTL-081]") {
    const bool spins_up = GENERATE(true, false);
    Config config = fixed_config();
    config.monitor.free_slip = 1.0F;
    Watch w(config);
    w.previous.rolling = true;
    const float free_radps = 60.0F / config.wheel.nominal_radius_m;
    w.sensors.flywheel.speed_radps = 60.0F / config.flywheel.radius_m;
    w.sensors.wheel.speed_radps = spins_up ? 20.0F : 0.6F * free_radps;
    for (int k = 0; k < 300; ++k) w.step();
    // 4,500 rad/s2: a light landing on dry asphalt.
    while (spins_up && w.sensors.wheel.speed_radps < 0.6F * free_radps) {
        w.sensors.wheel.speed_radps += 4.5F;
        REQUIRE(w.step().empty());
    }
    w.sensors.wheel.speed_radps *= 0.7F;
    FaultSet all;
    for (int k = 0; k < 8; ++k) all.insert(w.step());
    CHECK(all.contains(Fault::speeds_disagree) != spins_up);
}

TEST_CASE("the fall of a slow wheel is not held against the brake", "[CTL-081]") {
    const bool slow = GENERATE(true, false);
    Config config = fixed_config();  // speeds are compared above 8 m/s: three times that
    config.monitor.free_slip = 1.0F;
    Watch w(config);
    w.previous.rolling = true;
    const float rim_mps = slow ? 23.0F : 27.0F;
    w.sensors.flywheel.speed_radps = rim_mps / config.flywheel.radius_m;
    w.sensors.wheel.speed_radps = rim_mps / config.wheel.nominal_radius_m;
    for (int k = 0; k < 300; ++k) w.step();
    w.sensors.wheel.speed_radps *= 0.6F;
    FaultSet all;
    for (int k = 0; k < 8; ++k) all.insert(w.step());
    CHECK(all.contains(Fault::speeds_disagree) != slow);
}
