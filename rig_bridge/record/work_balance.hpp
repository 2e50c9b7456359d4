/// Work of brake and tyre since brake-on: from the load cells, or from the speeds while those are silent. Load cell values pass through PLC and
/// bridge: with a silent PLC, a hanging bridge or a broken bus they are missing or old.
///
/// Each step provides both: the work by load cells since the newest knot, and the step's work by speeds. A knot is a new reading, not a repetition;
/// readings are interpolated linearly between knots, so that their spacing matters little. The work by speeds is the kinetic energy lost, divided by
/// slip:
///
///     E_tyre = lambda d(m v^2 / 2), E_brake = (1 - lambda) d(m v^2 / 2) + d(J_w omega^2 / 2)
///
/// After kSilent_s without a reading the work by speeds is used, from the newest knot on, until readings have come for kBack_s: a speed is a mean
/// over a window, and the first one after a gap covers the gap. The work by speeds includes bearing drag, windage and the error of the wheel's
/// radius.
#pragma once

#include <cstdint>

namespace rig::record {

/// The bridge repeats a reading of the load cells on the bus for this time at most; a PLC may take as long between two counts of its plc_watchdog.
inline constexpr double kRepeated_s = 0.1;

struct Work {
    double brake_J = 0.0;
    double tyre_J = 0.0;
    double torque_Nms = 0.0;          ///< brake torque over time
    double sliding_torque_Nms = 0.0;  ///< the same down to drop-out
    double friction_way_m = 0.0;      ///< F_x / F_z over the way, down to drop-out

    Work& operator+=(const Work& other);
};

/// State of the load cell values in one step.
enum class CellReading : std::uint8_t { none, repeated, fresh };

/// Work since the time of the newest reading, which is older than the step.
struct WorkAhead {
    Work by_cells;  ///< if the reading held
    Work by_speeds;
};

class WorkBalance {
  public:
    explicit WorkBalance(double time_s = 0.0) : heard_s_(time_s), knot_s_(time_s) {}

    /// Adds a step up to `time_s`, which must not decrease: `by_cells` since the newest knot, `by_speeds` since the last step, both up to the time of
    /// the newest reading, and `ahead` of it. True: new knot.
    bool add(double time_s, CellReading reading, const Work& by_cells, const Work& by_speeds, const WorkAhead& ahead = {});

    [[nodiscard]] Work work() const;
    /// Whether the work by speeds is used now.
    [[nodiscard]] bool silent() const { return silent_; }
    /// The part of work() from speeds, and its duration.
    [[nodiscard]] Work by_speeds() const;
    [[nodiscard]] double silent_s() const { return closed_s_ + (silent_ ? now_s_ - knot_s_ : 0.0); }

  private:
    static constexpr double kSilent_s = 0.1;  // ten frames
    static constexpr double kBack_s = 0.03;

    bool close();

    Work work_;        // up to the time of the newest reading
    WorkAhead ahead_;  // of it
    Work knot_;        // as it stood there
    Work since_knot_;  // by the speeds
    double heard_s_;
    double knot_s_;
    double now_s_ = 0.0;
    bool silent_ = false;
    bool back_ = false;
    double back_s_ = 0.0;
    Work closed_;  // by the speeds, in silences that are over
    double closed_s_ = 0.0;
};

}  // namespace rig::record
