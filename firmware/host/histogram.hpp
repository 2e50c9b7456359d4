/// Histogram of durations with a fixed relative resolution, after HdrHistogram: exact below 64 ns, better
/// than 1.6 % above.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/control/types.hpp"

namespace antiskid::host {

/// No allocation, constant work per `add`. Not thread-safe: read only while no thread writes. About 18 KiB.
class Histogram {
  public:
    /// Counts one duration. Negative ones count as 0, those above `kLargest` into the last bucket; minimum,
    /// maximum and mean stay exact in both cases.
    void add(control::Time duration);

    [[nodiscard]] std::uint64_t count() const { return count_; }
    /// All four: zero while empty.
    [[nodiscard]] control::Time minimum() const { return control::Time{count_ == 0 ? 0 : minimum_}; }
    [[nodiscard]] control::Time maximum() const { return control::Time{count_ == 0 ? 0 : maximum_}; }
    [[nodiscard]] double mean_ns() const;
    /// Smallest bucket bound that at least the share `fraction` (0 to 1) of the durations does not exceed:
    /// never below the exact percentile (nearest rank), at most 1/64 above it.
    [[nodiscard]] control::Time percentile(double fraction) const;

    static constexpr control::Time kLargest{(std::int64_t{1} << 40) - 1};  ///< 18 minutes

  private:
    static constexpr int kSubBits = 6;  ///< 64 buckets an octave
    static constexpr int kOctaves = 40 - kSubBits;
    static constexpr std::size_t kBuckets = std::size_t{kOctaves + 1} << kSubBits;
    static std::size_t bucket_of(std::uint64_t value);
    static std::uint64_t upper_bound_of(std::size_t bucket);

    std::array<std::uint64_t, kBuckets> buckets_{};
    std::uint64_t count_ = 0;
    std::int64_t minimum_ = INT64_MAX;
    std::int64_t maximum_ = INT64_MIN;
    double sum_ = 0.0;
};

}  // namespace antiskid::host
