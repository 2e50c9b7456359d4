/// The last ten seconds of speed, slip and pressure as plain text. Pure.
#pragma once

#include <deque>
#include <string>
#include <vector>

namespace rig {

struct StripSample {
    double time_s = 0.0;
    double rim_mps = 0.0;
    double wheel_mps = 0.0;
    double slip = 0.0;
    double slip_reference = 0.0;
    double pressure_Pa = 0.0;
};

class StripChart {
  public:
    static constexpr double kLength_s = 10.0;
    static constexpr std::size_t kColumns = 60;  ///< of the strip; with its scale a line has kWidth
    static constexpr std::size_t kWidth = 79;
    static constexpr std::size_t kRows = 4;  ///< of each strip

    /// Time that does not grow begins anew.
    void add(const StripSample& sample);
    /// Three strips and the axis of time; * rim, o wheel, * slip, - its reference, * pressure. Left of what was seen it is empty.
    [[nodiscard]] std::vector<std::string> lines() const;

  private:
    std::deque<StripSample> samples_;
};

}  // namespace rig
