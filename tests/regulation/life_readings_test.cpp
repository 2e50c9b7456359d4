#include "rig_bridge/wear/life_readings.hpp"

#include <cmath>

#include "rig_bridge/wear/draw.hpp"
#include "tests/catch.hpp"

using wear::LifeReadings;

TEST_CASE("exact readings tell the life; without readings it is the expected one", "[STUDY-168]") {
    LifeReadings readings(4e9, 0.12, 0.0);
    CHECK(readings.life_J() == Approx(4e9));
    readings.read(3e9, 0.6);
    CHECK(readings.life_J() == Approx(5e9).epsilon(1e-6));
    LifeReadings sure(4e9, 0.0, 0.02);
    sure.read(3e9, 0.6);
    CHECK(sure.life_J() == Approx(4e9).epsilon(1e-4));
}

TEST_CASE("noisy readings are unbiased, and weighed against what is expected as Bayes says", "[STUDY-168]") {
    constexpr double kExpected_J = 4e9, kSpread = 0.12, kError = 0.02;
    constexpr int kBrakes = 4000;
    double off = 0.0;
    double squares = 0.0;
    double believed = 0.0;
    for (int brake = 0; brake < kBrakes; ++brake) {
        wear::Generator generator = wear::generator_of(31, static_cast<std::uint64_t>(brake));
        const double wear_per_J = (1.0 + kSpread * wear::normal(generator)) / kExpected_J;
        LifeReadings readings(kExpected_J, kSpread, kError);
        double sum = 1.0 / (kSpread * kSpread);
        for (const double taken_J : {2.9e9, 3.1e9, 3.3e9}) {
            readings.read(taken_J, taken_J * wear_per_J + kError * wear::normal(generator));
            sum += std::pow(taken_J / kExpected_J / kError, 2);
        }
        const double error = (1.0 / readings.life_J() - wear_per_J) * kExpected_J;
        off += error / kBrakes;
        squares += error * error / kBrakes;
        believed += 1.0 / sum / kBrakes;
    }
    CHECK(std::abs(off) < 4.0 * std::sqrt(squares / kBrakes));
    CHECK(squares == Approx(believed).epsilon(0.1));
}
