/// Latencies summed up: the same figures whoever measured them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/host/settings/json.hpp"

namespace antiskid::bench {

/// In microseconds. A percentile is the nearest rank: the smallest latency that at least this share of all
/// does not exceed.
struct Percentiles {
    std::uint64_t count = 0;
    double p50_us = 0.0;
    double p99_us = 0.0;
    double p99_9_us = 0.0;
    double max_us = 0.0;
};

/// Exact; reorders `latencies_ns`, which must not be empty.
[[nodiscard]] Percentiles exact(std::vector<std::int64_t>& latencies_ns);

/// One of the `durations` of a report of antiskid-controller. Upper bounds of buckets 1/64 wide: 1 us at 64 to 128 us.
[[nodiscard]] Percentiles from_report(const settings::Json& report, const std::string& duration);

/// The only thread of `cyclictest --json`. It cuts to whole microseconds, so these are upper bounds of buckets
/// 1 us wide. What its histogram did not hold (its option -h) stands at the maximum.
[[nodiscard]] Percentiles from_cyclictest(const settings::Json& result);

/// Each figure's median over the rounds, which must not be none; counts are added.
[[nodiscard]] Percentiles median(const std::vector<Percentiles>& rounds);

}  // namespace antiskid::bench
