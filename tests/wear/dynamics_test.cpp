#include "plant_sim/wear/dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "rig_bridge/wear/draw.hpp"
#include "tests/catch.hpp"

namespace {

using wear::Curve;

// The families of config/landing_gear.toml, and two simpler ones.
const Curve kLight{1.10, -0.16, -0.06, 0.0};
const Curve kMedium{1.15, -0.60, 0.45, 0.0};
const Curve kHeavy{1.22, -1.02, 0.72, 0.20};
const Curve kLine{1.08, -0.16, 0.0, 0.0};
const Curve kFlat{1.0, 0.0, 0.0, 0.0};

double at(const Curve& c, double x) {
    return c[0] + x * (c[1] + x * (c[2] + x * c[3]));
}

/// How a stop strays from the curve of its class.
struct Scatter {
    double sample = 0.005;  ///< of mu_b, correlated from sample to sample by `memory`
    double memory = 0.8;
    double shape = 0.0;  ///< of a tilt x - 1/2 and a bend x^2 - 1/3 that each stop has of its own
};

constexpr double kGain_m3 = 3.47e-3;
constexpr double kBrakeOn_mps = 50.0;

/// A stop with falling pressure and a deceleration that is not constant, 20 ms a sample.
wear::RecordedStop stop_of(const Curve& curve, const Scatter& scatter, std::uint64_t seed, std::uint64_t number) {
    wear::Generator generator = wear::generator_of(seed, number);
    const double mean = 0.3 * (1.0 + 0.1 * wear::normal(generator));
    const double tilt = scatter.shape * wear::normal(generator);
    const double bend = scatter.shape * wear::normal(generator);
    wear::RecordedStop stop{"stop " + std::to_string(number), kBrakeOn_mps, kGain_m3, {}};
    double noise = scatter.sample * wear::normal(generator);
    double v = kBrakeOn_mps;
    for (int i = 0; v > 2.0; ++i) {
        const double x = v / kBrakeOn_mps;
        const double f = at(curve, x) + tilt * (x - 1.0 / 2.0) + bend * (x * x - 1.0 / 3.0);
        const double pressure = (i < 5 ? 0.2 * i : 1.0) * (6e6 + 3e6 * x);
        stop.samples.push_back({0.02 * i, v, pressure, kGain_m3 * pressure * mean * (f + noise)});
        noise = scatter.memory * noise + scatter.sample * std::sqrt(1.0 - scatter.memory * scatter.memory) * wear::normal(generator);
        v -= 0.02 * (9.0 + 4.0 * x);
    }
    return stop;
}

std::vector<wear::RecordedStop> stops_of(const Curve& curve, const Scatter& scatter, std::uint64_t seed, std::uint64_t count) {
    std::vector<wear::RecordedStop> stops;
    for (std::uint64_t i = 1; i <= count; ++i) stops.push_back(stop_of(curve, scatter, seed, i));
    return stops;
}

double mean_of(const Curve& c) {
    return c[0] + c[1] / 2.0 + c[2] / 3.0 + c[3] / 4.0;
}

std::string rejection_of_stops(const std::vector<wear::RecordedStop>& stops) {
    try {
        (void)wear::learn_dynamics(stops, {});
    } catch (const settings::Error& e) {
        return e.what();
    }
    return "accepted";
}

double greatest_difference(const wear::FrictionDynamics& a, const Curve& b) {
    double greatest = 0.0;
    for (int i = 0; i <= 100; ++i) greatest = std::max(greatest, std::abs(a.at(i / 100.0) - at(b, i / 100.0)));
    return greatest;
}

}  // namespace

TEST_CASE("without scatter the curve comes back exactly, with the mean 1 and each stop's own mean", "[WEAR-040]") {
    for (const Curve& truth : {kFlat, kLine, kLight, kMedium, kHeavy}) {
        const wear::FrictionDynamics found = wear::learn_dynamics(stops_of(truth, {0.0, 0.0, 0.0}, 3, 5), {});
        for (std::size_t k = 0; k < truth.size(); ++k) CHECK(found.curve[k] == Approx(truth[k]).margin(1e-6));
        CHECK(mean_of(found.curve) == Approx(1.0).epsilon(1e-12));
        for (const wear::StopShape& stop : found.stops) {
            wear::Generator generator = wear::generator_of(3, static_cast<std::uint64_t>(&stop - found.stops.data()) + 1);
            CHECK(stop.mean_friction == Approx(0.3 * (1.0 + 0.1 * wear::normal(generator))).epsilon(1e-6));
        }
    }
}

TEST_CASE("the order is found", "[WEAR-040]") {
    constexpr int kSeeds = 25;
    struct Case {
        Curve truth;
        std::size_t order;
    };
    for (const Case& c : {Case{kFlat, 0}, Case{kLine, 1}, Case{kMedium, 2}, Case{kLight, 2}, Case{kHeavy, 3}}) {
        int right = 0;
        for (int seed = 1; seed <= kSeeds; ++seed) {
            const auto order = wear::learn_dynamics(stops_of(c.truth, {}, static_cast<std::uint64_t>(seed), 6), {}).order;
            right += order == c.order ? 1 : 0;
        }
        INFO("order " << c.order << ": " << right << " of " << kSeeds);
        CHECK(right >= kSeeds * 4 / 5);
    }
}

// Each stop has a shape of its own, and its samples remember each other: intervals that counted samples would be several times too narrow.
TEST_CASE("95 % intervals hold the truth in 90 to 99 % of draws, though samples are correlated and stops differ", "[WEAR-040]") {
    constexpr int kSeeds = 100;
    constexpr std::array<double, 3> kAt{0.0, 0.5, 1.0};
    std::array<int, kAt.size()> held{};
    double widths = 0.0;
    double errors = 0.0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        wear::DynamicsSettings settings;
        const wear::FrictionDynamics found =
            wear::learn_dynamics(stops_of(kMedium, {0.01, 0.9, 0.03}, static_cast<std::uint64_t>(seed), 8), settings);
        CHECK(found.by_stops);
        for (std::size_t i = 0; i < kAt.size(); ++i) {
            const double error = std::abs(found.at(kAt[i]) - at(kMedium, kAt[i]));
            held[i] += error <= found.half_width_at(kAt[i]) ? 1 : 0;
            widths += found.half_width_at(kAt[i]) / kSeeds;
            errors += error / kSeeds;
        }
    }
    for (const int h : held) {
        CHECK(h >= 90);
        CHECK(h <= 99);
    }
    // And they are no wider than they must be: the mean error of a normal estimate is 0.8 / 2.36 of the half width for 8 stops.
    CHECK(widths / errors < 1.5 * 2.36 / 0.8);
}

TEST_CASE("spikes and a torque cell that slips do not move the curve", "[WEAR-040]") {
    const auto clean = stops_of(kHeavy, {}, 11, 6);
    const double before = greatest_difference(wear::learn_dynamics(clean, {}), kHeavy);
    REQUIRE(before < 0.006);

    auto spiked = clean;
    wear::Generator generator = wear::generator_of(1, 1);
    for (wear::RecordedStop& stop : spiked)
        for (wear::BrakeSample& s : stop.samples)
            if (wear::uniform(generator) < 0.1) s.brake_torque_Nm *= 3.0 * wear::uniform(generator);
    CHECK(greatest_difference(wear::learn_dynamics(spiked, {}), kHeavy) < 0.01);

    // From a third of the stop on the cell reads 70 % of the torque.
    auto slipped = clean;
    auto& samples = slipped[2].samples;
    for (std::size_t i = samples.size() / 3; i < samples.size(); ++i) samples[i].brake_torque_Nm *= 0.7;
    const wear::FrictionDynamics found = wear::learn_dynamics(slipped, {});
    CHECK(greatest_difference(found, kHeavy) < 0.01);
    CHECK(found.stops[2].rejected > 0.2);
    CHECK(found.stops[1].rejected < 0.05);

    // A cell that drifts through the whole stop leaves no curve to share.
    auto drifting = clean;
    for (std::size_t i = 0; i < drifting[4].samples.size(); ++i)
        drifting[4].samples[i].brake_torque_Nm *= 1.0 + 4.0 * static_cast<double>(i) / static_cast<double>(samples.size());
    const wear::FrictionDynamics without = wear::learn_dynamics(drifting, {});
    CHECK_FALSE(without.stops[4].used);
    CHECK(without.stops[3].used);
    CHECK(greatest_difference(without, kHeavy) < 0.01);
}

TEST_CASE("one stop is enough for a curve, and says that its intervals come from bands of speed", "[WEAR-040]") {
    const wear::FrictionDynamics found = wear::learn_dynamics(stops_of(kMedium, {}, 5, 1), {});
    CHECK_FALSE(found.by_stops);
    CHECK(found.order == 2);
    CHECK(greatest_difference(found, kMedium) < 0.02);
}

TEST_CASE("bad recordings are refused with stop and sample", "[WEAR-040]") {
    const auto good = stops_of(kLight, {}, 2, 2);
    CHECK_THAT(rejection_of_stops({}), ContainsSubstring("no stop"));
    auto bad = good;
    for (wear::BrakeSample& s : bad[1].samples) s.pressure_Pa = 0.0;
    CHECK_THAT(rejection_of_stops(bad), ContainsSubstring("stop 2: no pressure in any of its"));
    bad = good;
    bad[0].samples[17].brake_torque_Nm = std::numeric_limits<double>::quiet_NaN();
    CHECK_THAT(rejection_of_stops(bad), ContainsSubstring("stop 1: sample 18: "));
    bad = good;
    bad[0].samples.resize(1);
    CHECK_THAT(rejection_of_stops(bad), ContainsSubstring("stop 1: "));
    bad = good;
    for (wear::BrakeSample& s : bad[0].samples) s.speed_mps = 30.0;
    CHECK_THAT(rejection_of_stops(bad), ContainsSubstring("stop 1: its speeds cover 0.60 to 0.60"));
    bad = good;
    std::swap(bad[0].samples[3].time_s, bad[0].samples[90].time_s);
    CHECK_THAT(rejection_of_stops(bad), ContainsSubstring("stop 1: sample 5: time"));
    bad = good;
    for (wear::BrakeSample& s : bad[1].samples) s.pressure_Pa *= 1e-5;  // bar
    CHECK_THAT(rejection_of_stops(bad), ContainsSubstring("check the units"));
    bad = good;
    bad[0].brake_on_mps = 0.0;
    CHECK_THAT(rejection_of_stops(bad), ContainsSubstring("brake-on speed"));
    bad = good;
    bad[0].brake_gain_m3 = -1.0;
    CHECK_THAT(rejection_of_stops(bad), ContainsSubstring("brake gain"));
}
