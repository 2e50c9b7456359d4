/// Whether the values of a channel can be what the map says, and which unit would make them so.
#pragma once

#include <cstdint>
#include <string>

#include "rig_bridge/replay/import_map.hpp"

namespace rig::replay {

/// What a channel of a brake rig can read, in SI as in Channel.
struct PlausibleRange {
    double lowest, highest;
    double lively;  ///< a recording with a braking in it reaches this at least
};
[[nodiscard]] const PlausibleRange& plausible(Channel channel);

/// Values of one channel over a whole recording.
class ChannelSurvey {
  public:
    /// `factor`: from the recorded number to SI.
    ChannelSurvey(Channel channel, double factor) : channel_(channel), factor_(factor) {}

    /// False for a value outside the plausible range.
    bool add(double recorded);

    [[nodiscard]] std::uint64_t count() const { return count_; }
    [[nodiscard]] std::uint64_t outside() const { return outside_; }
    [[nodiscard]] double lowest() const { return lowest_; }
    [[nodiscard]] double highest() const { return highest_; }

    /// More than one value in a hundred is outside, or none is lively.
    [[nodiscard]] bool wrong_unit() const;
    /// The units in which all would be plausible and lively, "bar, kPa"; `radius_m` takes a shaft's speed to the rim.
    [[nodiscard]] std::string likely_units(const ImportColumn& column, double radius_m) const;

  private:
    Channel channel_;
    double factor_;
    std::uint64_t count_ = 0, outside_ = 0;
    double lowest_ = 0.0, highest_ = 0.0;  // as recorded
};

/// The units of a flywheel's speed that are `ratio` times the one of `column`, within a fifth.
[[nodiscard]] std::string units_at_ratio(const ImportColumn& column, double ratio, double radius_m);

/// The units of pressure that are `ratio` times the one of `column`, within a factor of two, as brakes differ.
[[nodiscard]] std::string pressure_units_at_ratio(const ImportColumn& column, double ratio);

/// From a recorded number to SI; `radius_m`: of the flywheel, for its speed.
[[nodiscard]] double factor_of(Channel channel, const antiskid::can::Unit& unit, double radius_m);

}  // namespace rig::replay
