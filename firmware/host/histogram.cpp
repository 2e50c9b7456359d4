#include "firmware/host/histogram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace antiskid::host {

namespace {
constexpr std::uint64_t kSubBuckets = 64;
}

std::size_t Histogram::bucket_of(const std::uint64_t value) {
    if (value < kSubBuckets) return value;
    const int shift = static_cast<int>(std::bit_width(value)) - 1 - kSubBits;
    return (static_cast<std::size_t>(shift) << kSubBits) + (value >> shift);
}

std::uint64_t Histogram::upper_bound_of(const std::size_t bucket) {
    if (bucket < kSubBuckets) return bucket;
    const std::size_t shift = (bucket >> kSubBits) - 1;
    const std::uint64_t mantissa = bucket - (shift << kSubBits);
    return ((mantissa + 1) << shift) - 1;
}

void Histogram::add(const control::Time duration) {
    const std::int64_t clamped = std::clamp(duration.count(), std::int64_t{0}, kLargest.count());
    ++buckets_[bucket_of(static_cast<std::uint64_t>(clamped))];
    ++count_;
    minimum_ = std::min(minimum_, duration.count());
    maximum_ = std::max(maximum_, duration.count());
    sum_ += static_cast<double>(duration.count());
}

double Histogram::mean_ns() const {
    return count_ == 0 ? 0.0 : sum_ / static_cast<double>(count_);
}

control::Time Histogram::percentile(const double fraction) const {
    if (count_ == 0) return control::Time{0};
    const auto wanted = static_cast<std::uint64_t>(std::ceil(fraction * static_cast<double>(count_)));
    const std::uint64_t rank = std::clamp<std::uint64_t>(wanted, 1, count_);
    std::uint64_t seen = 0;
    for (std::size_t bucket = 0; bucket < kBuckets; ++bucket) {
        seen += buckets_[bucket];
        if (seen >= rank) {
            const auto bound = static_cast<std::int64_t>(upper_bound_of(bucket));
            // Only the last bucket can hold more than its bound.
            return control::Time{bucket + 1 == kBuckets ? maximum_ : std::min(bound, maximum_)};
        }
    }
    return control::Time{maximum_};
}

}  // namespace antiskid::host
