/// Summary of latencies, the same for every source.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/host/settings/json.hpp"

namespace antiskid::bench {

/// In microseconds. Percentiles are by nearest rank: the smallest latency that at least this share of all does not exceed.
struct Percentiles {
    std::uint64_t count = 0;
    double p50_us = 0.0;
    double p99_us = 0.0;
    double p99_9_us = 0.0;
    double max_us = 0.0;
};

/// Exact values; reorders `latencies_ns`, which must not be empty.
[[nodiscard]] Percentiles exact(std::vector<std::int64_t>& latencies_ns);

/// One of the `durations` of a report of antiskid-controller. Values are upper bounds of buckets with a relative width of 1/64: 1 us at 64 to 128 us.
[[nodiscard]] Percentiles from_report(const settings::Json& report, const std::string& duration);

/// The only thread of `cyclictest --json`. It cuts off fractions of a microsecond, so that values are upper bounds of buckets of 1 us. Latencies
/// beyond its histogram (its option -h) count as the maximum.
[[nodiscard]] Percentiles from_cyclictest(const settings::Json& result);

[[nodiscard]] settings::Json as_json(const Percentiles& p);

/// Median of each figure over the rounds, of which there must be one; counts are added.
[[nodiscard]] Percentiles median(const std::vector<Percentiles>& rounds);

}  // namespace antiskid::bench
