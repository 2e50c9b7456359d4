/// Checks whether a channel's values are plausible in the unit of the map, and suggests units that would be.
#pragma once

#include <cstdint>
#include <string>

#include "rig_bridge/replay/import_map.hpp"

namespace rig::replay {

/// Plausible range of a channel of a brake rig, in SI units as in Channel.
struct PlausibleRange {
    double lowest, highest;
    double lively;  ///< a recording with braking reaches at least this
};
[[nodiscard]] const PlausibleRange& plausible(Channel channel);

/// Statistics of one channel over a whole recording.
class ChannelSurvey {
  public:
    /// `factor`: from the recorded number to SI.
    ChannelSurvey(Channel channel, double factor) : channel_(channel), factor_(factor) {}

    /// False for a value outside the plausible range.
    bool add(double recorded);

    [[nodiscard]] std::uint64_t count() const { return count_; }
    [[nodiscard]] std::uint64_t outside() const { return outside_; }
    [[nodiscard]] double factor() const { return factor_; }
    [[nodiscard]] double lowest() const { return lowest_; }
    [[nodiscard]] double highest() const { return highest_; }

    /// Whether more than 1 % of the values are out of range, or none reaches `lively`.
    [[nodiscard]] bool wrong_unit() const;
    /// Units in which all values would be plausible, e.g. "bar, kPa"; `radius_m` converts a shaft's speed to rim speed.
    [[nodiscard]] std::string likely_units(const ImportColumn& column, double radius_m) const;

  private:
    Channel channel_;
    double factor_;
    std::uint64_t count_ = 0, outside_ = 0;
    double lowest_ = 0.0, highest_ = 0.0;  // as recorded
};

/// Units of flywheel speed that are `ratio` times that of `column`, within 20 %.
[[nodiscard]] std::string units_at_ratio(const ImportColumn& column, double ratio, double radius_m);

/// Units of pressure that are `ratio` times that of `column`, within a factor of two, because brakes differ.
[[nodiscard]] std::string pressure_units_at_ratio(const ImportColumn& column, double ratio);

/// Factor from a recorded number to SI units; `radius_m`: of the flywheel, for its speed.
[[nodiscard]] double factor_of(Channel channel, const antiskid::can::Unit& unit, double radius_m);

}  // namespace rig::replay
