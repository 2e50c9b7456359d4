#include "plant_sim/bench/percentiles.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace antiskid::bench {

namespace {

/// From 1.
std::uint64_t rank(const double share, const std::uint64_t count) {
    const auto min = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(count)));
    return std::clamp<std::uint64_t>(min, 1, count);
}

double middle(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

}  // namespace

Percentiles exact(std::vector<std::int64_t>& latencies_ns) {
    std::sort(latencies_ns.begin(), latencies_ns.end());
    const std::uint64_t count = latencies_ns.size();
    const auto at = [&](double share) { return static_cast<double>(latencies_ns[rank(share, count) - 1]) * 1e-3; };
    return {.count = count, .p50_us = at(0.5), .p99_us = at(0.99), .p99_9_us = at(0.999), .max_us = at(1.0)};
}

Percentiles from_report(const settings::Json& report, const std::string& duration) {
    const settings::Json& figures = report.at("durations").at(duration);
    const auto us = [&](const char* key) { return figures.at(key).get<double>() * 1e-3; };
    return {.count = figures.at("count").get<std::uint64_t>(),
            .p50_us = us("p50_ns"),
            .p99_us = us("p99_ns"),
            .p99_9_us = us("p99_9_ns"),
            .max_us = us("max_ns")};
}

Percentiles from_cyclictest(const settings::Json& result) {
    const settings::Json& thread = result.at("thread").at("0");
    std::map<std::uint64_t, std::uint64_t> counts;
    for (const auto& [bucket, number] : thread.at("histogram").items()) counts[std::stoull(bucket)] = number.get<std::uint64_t>();
    const auto count = thread.at("cycles").get<std::uint64_t>();
    const double max = thread.at("max").get<double>() + 1.0;
    const auto at = [&](double share) {
        std::uint64_t so_far = 0;
        for (const auto& [bucket, number] : counts) {
            so_far += number;
            if (so_far >= rank(share, count)) return static_cast<double>(bucket) + 1.0;
        }
        return max;
    };
    return {.count = count, .p50_us = at(0.5), .p99_us = at(0.99), .p99_9_us = at(0.999), .max_us = max};
}

settings::Json as_json(const Percentiles& p) {
    return {{"count", p.count}, {"p50_us", p.p50_us}, {"p99_us", p.p99_us}, {"p99_9_us", p.p99_9_us}, {"max_us", p.max_us}};
}

Percentiles median(const std::vector<Percentiles>& rounds) {
    const auto of = [&](double Percentiles::*figure) {
        std::vector<double> values;
        values.reserve(rounds.size());
        for (const Percentiles& round : rounds) values.push_back(round.*figure);
        return middle(values);
    };
    Percentiles all{.count = 0,
                    .p50_us = of(&Percentiles::p50_us),
                    .p99_us = of(&Percentiles::p99_us),
                    .p99_9_us = of(&Percentiles::p99_9_us),
                    .max_us = of(&Percentiles::max_us)};
    for (const Percentiles& round : rounds) all.count += round.count;
    return all;
}

}  // namespace antiskid::bench
