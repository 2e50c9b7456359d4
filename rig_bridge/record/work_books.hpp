/// Work of brake and tyre since brake-on: by the load cells, and where those are silent by the speeds. Load cells come through PLC and bridge;
/// of a braking with a silent PLC, a standing bridge or a cut bus they say nothing, or what was true before.
///
/// Each step brings both, the work by the readings in hand since the newest knot, and its own work by the speeds. A knot is a reading that was
/// not the one before it said again; between two knots readings are linear, so that it costs little how far apart they come. By the speeds it is
/// the kinetic energy that was lost, shared by slip:
///
///     E_tyre = lambda d(m v^2 / 2), E_brake = (1 - lambda) d(m v^2 / 2) + d(J_w omega^2 / 2)
///
/// After kSilent_s without a reading the speeds count, from the newest knot on, until readings have come for kBack_s: a speed is that of a window,
/// and the first one after a hole is that of the hole. Drag of the flywheel's bearings, windage and an error of the wheel's radius are in the
/// work by the speeds.
#pragma once

#include <cstdint>

namespace rig::record {

struct Work {
    double brake_J = 0.0;
    double tyre_J = 0.0;
    double torque_Nms = 0.0;          ///< brake torque over time
    double sliding_torque_Nms = 0.0;  ///< the same down to drop-out
    double friction_way_m = 0.0;      ///< F_x / F_z over the way, down to drop-out

    Work& operator+=(const Work& other);
};

/// Of the load cells, in one step.
enum class CellReading : std::uint8_t { none, repeated, fresh };

class WorkBooks {
  public:
    explicit WorkBooks(double time_s = 0.0) : heard_s_(time_s), knot_s_(time_s) {}

    /// Until `time_s`, which must not fall: `by_cells` since the newest knot, `by_speeds` since the step before. True: here is a new knot.
    bool add(double time_s, CellReading reading, const Work& by_cells, const Work& by_speeds);

    [[nodiscard]] const Work& work() const { return work_; }
    /// The speeds count now.
    [[nodiscard]] bool silent() const { return silent_; }
    /// Of work(), what the speeds have said; and for how long they did.
    [[nodiscard]] Work by_speeds() const;
    [[nodiscard]] double silent_s() const { return closed_s_ + (silent_ ? now_s_ - knot_s_ : 0.0); }

  private:
    static constexpr double kSilent_s = 0.1;    // ten frames
    static constexpr double kRepeated_s = 0.1;  // load_cells_ms of bridge.toml: so long an old reading is said again
    static constexpr double kBack_s = 0.03;

    bool close();

    Work work_;
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
