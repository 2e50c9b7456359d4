// Percentiles are held against the exact ones of the sorted samples.
#include "firmware/host/histogram.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "tests/catch.hpp"

using antiskid::control::Time;
using antiskid::host::Histogram;

namespace {

std::int64_t exact_percentile(const std::vector<std::int64_t>& sorted, const double fraction) {
    const auto rank = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(sorted.size())));
    return sorted[std::max<std::size_t>(rank, 1) - 1];
}

void agrees_with_exact(std::vector<std::int64_t> samples) {
    const auto histogram = std::make_unique<Histogram>();
    double sum = 0.0;
    for (const std::int64_t sample : samples) {
        histogram->add(Time{sample});
        sum += static_cast<double>(sample);
    }
    std::sort(samples.begin(), samples.end());
    REQUIRE(histogram->count() == samples.size());
    REQUIRE(histogram->minimum().count() == samples.front());
    REQUIRE(histogram->maximum().count() == samples.back());
    REQUIRE(histogram->mean_ns() == Approx(sum / static_cast<double>(samples.size())));
    for (const double fraction : {0.0, 0.001, 0.1, 0.25, 0.5, 0.75, 0.9, 0.99, 0.999, 0.9999, 1.0}) {
        const std::int64_t exact = exact_percentile(samples, fraction);
        const std::int64_t estimate = histogram->percentile(fraction).count();
        INFO("fraction " << fraction << " exact " << exact << " estimate " << estimate);
        CHECK(estimate >= exact);
        CHECK(static_cast<double>(estimate) <= static_cast<double>(exact) * (1.0 + 1.0 / 64.0));
    }
}

}  // namespace

TEST_CASE("percentiles are never below the exact ones and at most 1/64 above", "[RT-073]") {
    std::mt19937_64 generator(20261);
    SECTION("wake-up latencies: log-normal around 70 us with a tail") {
        std::lognormal_distribution<double> latency(std::log(70e3), 0.6);
        std::vector<std::int64_t> samples(100'000);
        for (auto& sample : samples) sample = static_cast<std::int64_t>(latency(generator));
        agrees_with_exact(samples);
    }
    SECTION("log-uniform over nine decades") {
        std::uniform_real_distribution<double> exponent(0.0, 11.0);
        std::vector<std::int64_t> samples(50'000);
        for (auto& sample : samples) sample = static_cast<std::int64_t>(std::pow(10.0, exponent(generator)));
        agrees_with_exact(samples);
    }
    SECTION("one sample") {
        agrees_with_exact({1'234'567});
    }
    SECTION("all equal") {
        agrees_with_exact(std::vector<std::int64_t>(1000, 1'000'000));
    }
    SECTION("every small value") {
        std::vector<std::int64_t> samples(5000);
        for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<std::int64_t>(i);
        agrees_with_exact(samples);
    }
}

TEST_CASE("every power of two and its neighbours fall into a bucket that holds them", "[RT-073]") {
    for (int bit = 1; bit < 40; ++bit)
        for (const std::int64_t offset : {-1, 0, 1}) {
            const std::int64_t value = (std::int64_t{1} << bit) + offset;
            const auto histogram = std::make_unique<Histogram>();
            histogram->add(Time{value});
            histogram->add(Histogram::kLargest);
            const std::int64_t bound = histogram->percentile(0.5).count();
            INFO(value);
            REQUIRE(bound >= value);
            REQUIRE(static_cast<double>(bound) <= static_cast<double>(value) * (1.0 + 1.0 / 64.0));
        }
}

TEST_CASE("durations out of range are counted, extremes stay exact", "[RT-073]") {
    const auto histogram = std::make_unique<Histogram>();
    histogram->add(Time{-5});
    histogram->add(Time{INT64_C(1) << 50});
    CHECK(histogram->count() == 2);
    CHECK(histogram->minimum() == Time{-5});
    CHECK(histogram->maximum() == Time{INT64_C(1) << 50});
    CHECK(histogram->percentile(0.5) == Time{0});
    CHECK(histogram->percentile(1.0) == Time{INT64_C(1) << 50});
}

TEST_CASE("an empty histogram is all zero", "[RT-073]") {
    const auto histogram = std::make_unique<Histogram>();
    CHECK(histogram->count() == 0);
    CHECK(histogram->minimum() == Time{0});
    CHECK(histogram->maximum() == Time{0});
    CHECK(histogram->percentile(0.99) == Time{0});
    CHECK(histogram->mean_ns() == 0.0);
}
