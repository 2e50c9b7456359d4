/// Encoders, pressure transducer and the random numbers behind them.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "plant_sim/model/rig.hpp"
#include "tests/catch.hpp"
#include "tests/model/scenarios.hpp"

namespace {

constexpr double kStep_s = 1e-3;
constexpr double kToothPitch_rad = 2.0 * std::numbers::pi / 60.0;
constexpr rig::EncoderParameters kClean{.teeth = 60.0, .jitter_s = 0.0, .slowest_edges_hz = 10.0};

rig::EncoderParameters with_jitter(double jitter_s) {
    rig::EncoderParameters parameters = kClean;
    parameters.jitter_s = jitter_s;
    return parameters;
}

/// A shaft at constant acceleration.
struct Shaft {
    double omega_0, acceleration;
    [[nodiscard]] double omega(double t) const { return omega_0 + acceleration * t; }
    [[nodiscard]] double angle(double t) const { return t * (omega_0 + 0.5 * acceleration * t); }
    /// When it has turned by `angle`.
    [[nodiscard]] double time_of(double angle) const { return 2.0 * angle / (omega_0 + std::sqrt(omega_0 * omega_0 + 2.0 * acceleration * angle)); }
};

/// Sum of squares of N standard normals lies within 5 of its standard deviations.
bool plausible_variance(double variance, double expected, double count, double kurtosis_factor) {
    return std::abs(variance / expected - 1.0) < 5.0 * std::sqrt(kurtosis_factor / count);
}

}  // namespace

TEST_CASE("encoder: counts are the exact angle, edge times the closed form at constant acceleration", "[RIG-070]") {
    for (const Shaft shaft : {Shaft{190.0, 0.0}, Shaft{190.0, -60.0}, Shaft{5.0, 900.0}, Shaft{40.0, -9.0}}) {
        CAPTURE(shaft.omega_0, shaft.acceleration);
        plant::Encoder encoder(kClean);
        rig::Random random(1);
        double worst_s = 0.0;
        std::uint32_t last = 0;
        for (int i = 1; i <= 1500; ++i) {
            const double now = i * kStep_s;
            if (shaft.omega(now) < 2.0) break;
            encoder.advance(shaft.angle(now), shaft.omega(now - kStep_s), shaft.omega(now), now, kStep_s, random);
            const auto edges = static_cast<std::uint32_t>(std::floor(shaft.angle(now) / kToothPitch_rad));
            REQUIRE(encoder.edge_count() == edges);
            if (edges == last) continue;
            last = edges;
            worst_s = std::max(worst_s, std::abs(encoder.edge_time_s() - shaft.time_of(edges * kToothPitch_rad)));
        }
        CHECK(last > 200);
        CHECK(worst_s < 1e-11);
    }
}

TEST_CASE("encoder: on the plant its last edge and count tell the speed", "[RIG-070]") {
    rig::RigParameters parameters = rig::load_rig("config", {}).rig;
    parameters.wheel_encoder.jitter_s = 0.0;
    parameters.flywheel_encoder.jitter_s = 0.0;
    plant::Rig rig(parameters, kStep_s, 1);
    rig.start_rolling();
    std::uint32_t count = 0;
    double time = 0.0;
    for (int i = 1; i <= 3000; ++i) {
        rig.advance_pressure(4e6, 4e6);
        if (i % 100 != 0) continue;
        const plant::Encoder& e = rig.flywheel_encoder();
        if (i > 100) {
            const double mean = (e.edge_count() - count) * kToothPitch_rad / (e.edge_time_s() - time) * parameters.flywheel_radius_m;
            // At constant deceleration the mean over 0.1 s is the speed half-way.
            const double then = rig.wheel().v_mps + 0.5 * (0.1 + rig.time_s() - e.edge_time_s()) * 3.4;
            CHECK(mean == Approx(then).epsilon(0.01));
            CHECK(e.speed_radps(rig.time_s()) * parameters.flywheel_radius_m == Approx(rig.wheel().v_mps).epsilon(0.01));
        }
        count = e.edge_count();
        time = e.edge_time_s();
        CHECK(count == static_cast<std::uint32_t>(std::floor(rig.wheel().distance_m / parameters.flywheel_radius_m / kToothPitch_rad)));
        CHECK(rig.wheel_encoder().edge_count() == static_cast<std::uint32_t>(std::floor(rig.wheel().angle_rad / kToothPitch_rad)));
    }
}

TEST_CASE("encoder: jitter has the given deviation and no bias; stamps never run back nor ahead of now", "[RIG-070]") {
    constexpr double kJitter_s = 5e-6;
    const Shaft shaft{150.0, 0.0};
    plant::Encoder encoder(with_jitter(kJitter_s));
    rig::Random random(20260103);
    double sum = 0.0;
    double squares = 0.0;
    double count = 0.0;
    double last_stamp = 0.0;
    for (int i = 1; i <= 60000; ++i) {
        const double now = i * kStep_s;
        encoder.advance(shaft.angle(now), shaft.omega_0, shaft.omega_0, now, kStep_s, random);
        REQUIRE(encoder.edge_time_s() >= last_stamp);
        REQUIRE(encoder.edge_time_s() <= now);
        if (encoder.edge_time_s() == last_stamp) continue;
        last_stamp = encoder.edge_time_s();
        const double truth = shaft.time_of(encoder.edge_count() * kToothPitch_rad);
        // An edge so near the sample that its stamp could not be late has its jitter cut: left out.
        if (now - truth < 4.0 * kJitter_s) continue;
        sum += last_stamp - truth;
        squares += (last_stamp - truth) * (last_stamp - truth);
        count += 1.0;
    }
    REQUIRE(count > 50000.0);
    CHECK(std::abs(sum / count) < 5.0 * kJitter_s / std::sqrt(count));
    CHECK(plausible_variance(squares / count, kJitter_s * kJitter_s, count, 2.0));
}

TEST_CASE("encoder: blind below ten edges a second, counts on when the shaft is fast again", "[RIG-070]") {
    plant::Encoder encoder(kClean);
    rig::Random random(1);
    double angle = 0.0;
    double now = 0.0;
    const auto turn = [&](double omega, double seconds) {
        for (int i = 0; i < std::lround(seconds / kStep_s); ++i) {
            now += kStep_s;
            angle += omega * kStep_s;
            encoder.advance(angle, omega, omega, now, kStep_s, random);
        }
    };
    const double limit_radps = 10.0 * kToothPitch_rad;
    turn(1.01 * limit_radps, 2.0);
    const std::uint32_t seen = encoder.edge_count();
    CHECK(seen == 20);
    CHECK(encoder.speed_radps(now) == Approx(1.01 * limit_radps).epsilon(1e-9));
    turn(0.99 * limit_radps, 5.0);
    CHECK(encoder.edge_count() == seen);
    CHECK(encoder.speed_radps(now) == 0.0);
    turn(100.0, 0.5);
    const auto missed = static_cast<std::uint32_t>(std::floor(5.0 * 9.9));
    CHECK(encoder.edge_count() >= seen + static_cast<std::uint32_t>(50.0 / kToothPitch_rad) - 1);
    CHECK(encoder.edge_count() <= static_cast<std::uint32_t>(angle / kToothPitch_rad) - missed + 2);
    CHECK(encoder.speed_radps(now) == Approx(100.0).epsilon(1e-6));
}

TEST_CASE("encoder: the count rolls over at 32 bits", "[RIG-070]") {
    plant::Encoder encoder(kClean);
    rig::Random random(1);
    // Two turns of the counter less one edge, in strides that a 32-bit number holds.
    const double almost = (4294967295.0 + 0.5) * kToothPitch_rad;
    double now = 0.0;
    for (const double angle : {0.5 * almost, almost}) {
        now += 1.0;
        encoder.advance(angle, 1e9, 1e9, now, 1.0, random);
    }
    CHECK(encoder.edge_count() == 4294967295U);
    encoder.advance(almost + 3.0 * kToothPitch_rad, 100.0, 100.0, now + kStep_s, kStep_s, random);
    CHECK(encoder.edge_count() == 2U);
}

TEST_CASE("sensors: the same seed gives the same readings, another seed others", "[RIG-070]") {
    const rig::RigParameters parameters = rig::load_rig("config", {}).rig;
    const auto readings = [&](std::uint64_t seed) {
        plant::Rig rig(parameters, kStep_s, seed);
        rig.start_rolling();
        std::vector<double> all;
        for (int i = 0; i < 500; ++i) {
            rig.advance_current(10.0);
            all.insert(all.end(), {rig.wheel_encoder().edge_time_s(), rig.flywheel_encoder().edge_time_s(), rig.measured_pressure_Pa(),
                                   rig.wheel().omega_radps});
        }
        return all;
    };
    const auto first = readings(1);
    CHECK(first == readings(1));
    const auto other = readings(2);
    CHECK(first != other);
    // The plant itself draws nothing.
    for (std::size_t i = 3; i < first.size(); i += 4) REQUIRE(first[i] == other[i]);
}

TEST_CASE("transducer: range, resolution, noise", "[RIG-070]") {
    rig::Random random(20260104);
    const rig::TransducerParameters clean{.range_Pa = 25e6, .noise_Pa = 0.0, .resolution_Pa = 5000.0};
    for (double p = 0.0; p <= 25e6; p += 12345.6) {
        const double reading = plant::reading_Pa(clean, p, random);
        CHECK(std::abs(reading - p) <= 2500.0);
        CHECK(std::fmod(reading, 5000.0) == 0.0);
    }
    CHECK(plant::reading_Pa(clean, -1e6, random) == 0.0);
    CHECK(plant::reading_Pa(clean, 26e6, random) == 25e6);

    const rig::TransducerParameters noisy{.range_Pa = 25e6, .noise_Pa = 20e3, .resolution_Pa = 0.0};
    constexpr double kCount = 200000.0;
    double sum = 0.0;
    double squares = 0.0;
    for (int i = 0; i < static_cast<int>(kCount); ++i) {
        const double error = plant::reading_Pa(noisy, 10e6, random) - 10e6;
        sum += error;
        squares += error * error;
    }
    CHECK(std::abs(sum / kCount) < 5.0 * 20e3 / std::sqrt(kCount));
    CHECK(plausible_variance(squares / kCount, 4e8, kCount, 2.0));
    for (int i = 0; i < 1000; ++i) {
        CHECK(plant::reading_Pa(noisy, 0.0, random) >= 0.0);
        CHECK(plant::reading_Pa(noisy, 25e6, random) <= 25e6);
    }
}

TEST_CASE("random: SplitMix64 as published", "[RIG-070]") {
    rig::Random from_zero(0);
    for (const std::uint64_t expected :
         {0xE220A8397B1DCDAFULL, 0x6E789E6AA1B965F4ULL, 0x06C45D188009454FULL, 0xF88BB8A8724C81ECULL, 0x1B39896A51A8749BULL}) {
        CHECK(from_zero.bits() == expected);
    }
    rig::Random random(1234567);
    for (const std::uint64_t expected :
         {6457827717110365317ULL, 3203168211198807973ULL, 9817491932198370423ULL, 4593380528125082431ULL, 16408922859458223821ULL}) {
        CHECK(random.bits() == expected);
    }
}

TEST_CASE("random: noise has mean 0, deviation 1, no third moment, its bound and nearly the normal law", "[RIG-070]") {
    rig::Random random(20260105);
    constexpr int kCount = 1000000;
    std::vector<double> draws(kCount);
    std::array<double, 5> moments{};
    double product = 0.0;
    double last = 0.0;
    for (double& x : draws) {
        x = random.noise();
        double power = 1.0;
        for (double& moment : moments) {
            moment += power / kCount;
            power *= x;
        }
        product += x * last / kCount;
        last = x;
    }
    const double sigma = 1.0 / std::sqrt(kCount);
    CHECK(std::abs(moments[1]) < 5.0 * sigma);
    CHECK(std::abs(moments[2] - 1.0) < 5.0 * std::sqrt(1.7) * sigma);
    CHECK(std::abs(moments[3]) < 5.0 * std::sqrt(15.0) * sigma);
    CHECK(std::abs(moments[4] - 2.7) < 0.05);
    CHECK(std::abs(product) < 5.0 * sigma);
    std::sort(draws.begin(), draws.end());
    CHECK(draws.front() >= -2.0 * std::sqrt(3.0));
    CHECK(draws.back() <= 2.0 * std::sqrt(3.0));
    double worst = 0.0;
    for (int i = 0; i < kCount; ++i) {
        const double normal = 0.5 * std::erfc(-draws[static_cast<std::size_t>(i)] / std::numbers::sqrt2);
        worst = std::max(worst, std::abs((i + 0.5) / kCount - normal));
    }
    CHECK(worst < 0.01);
}

TEST_CASE("teeth that stand in the wrong place move their stamps, not their number nor the mean speed", "[RIG-070]") {
    rig::EncoderParameters off = kClean;
    off.pitch_error = 0.02;
    off.eccentricity = 0.003;
    plant::Encoder sound(kClean), worn(off);
    rig::Random random(1);
    constexpr double kOmega = 100.0;
    double max_s = 0.0, first_s = 0.0, last_s = 0.0;
    std::uint32_t first = 0;
    double slowest = 1e9, fastest = 0.0;
    for (int i = 1; i <= 20'000; ++i) {
        const double t = i * kStep_s;
        sound.advance(kOmega * t, kOmega, kOmega, t, kStep_s, random);
        worn.advance(kOmega * t, kOmega, kOmega, t, kStep_s, random);
        REQUIRE(sound.edge_count() == worn.edge_count());
        max_s = std::max(max_s, std::abs(worn.edge_time_s() - sound.edge_time_s()));
        if (i == 100) {
            first_s = worn.edge_time_s();
            first = worn.edge_count();
        }
        if (i > 100) {
            slowest = std::min(slowest, worn.speed_radps(t));
            fastest = std::max(fastest, worn.speed_radps(t));
        }
        last_s = worn.edge_time_s();
    }
    // Neighbours are apart by as much as both are off: 2 % of the pitch each way, 0.3 % by the ring, over one edge.
    CHECK(max_s <= (0.02 * kToothPitch_rad + 0.003) / kOmega + 1e-9);
    CHECK(max_s > 0.5 * 0.02 * kToothPitch_rad / kOmega);
    CHECK((worn.edge_count() - first) * kToothPitch_rad / (last_s - first_s) == Approx(kOmega).epsilon(1e-4));
    CHECK(slowest < 0.99 * kOmega);
    CHECK(fastest > 1.01 * kOmega);
    CHECK(slowest > 0.93 * kOmega);
    CHECK(fastest < 1.07 * kOmega);
}
