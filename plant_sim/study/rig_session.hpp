/// The rig's side of a maneuver, without the transport of frames: plant, pilot and meter with one period.
///
///     while (!session.done()) {
///         send(session.sample());              // over CAN, or in process
///         session.advance(received_current, reported_state);  // held for one period
///     }
#pragma once

#include <cstdint>
#include <functional>

#include "firmware/can/rig_sample.hpp"
#include "plant_sim/model/rig.hpp"
#include "plant_sim/study/pilot.hpp"
#include "plant_sim/study/stop_meter.hpp"

namespace study {

struct SessionOptions {
    ManeuverPlan plan;
    /// Slip reference commanded in each period, computed from the present rig; empty: always that of `plan`.
    std::function<double(const plant::Rig&)> slip_reference{};
    double period_s = 1e-3;     ///< control period, a multiple of 1 ms
    double drop_out_mps = 5.0;  ///< end of eq. (16)
    double longest_s = 600.0;   ///< a run without standstill ends here
    std::uint64_t seed = 1;
};

class RigSession {
  public:
    RigSession(const rig::RigParameters& rig, const SessionOptions& options);

    /// Values of sensors and pilot in this period.
    [[nodiscard]] const antiskid::can::RigSample& sample() const { return sample_; }
    [[nodiscard]] antiskid::can::LoadCellSample load_cells() const;

    /// Advances by one period with a constant valve current. `controller`: the newest state that the controller reported.
    void advance(double current_mA, antiskid::control::State controller);

    [[nodiscard]] bool done() const { return pilot_.phase() == StopPhase::done || abandoned() || timed_out(); }
    /// Whether the controller has been in its safe state for kPatience_s of the braking phase, so that nothing brakes.
    [[nodiscard]] bool abandoned() const { return safe_s_ >= kPatience_s; }
    static constexpr double kPatience_s = 1.0;
    [[nodiscard]] bool timed_out() const { return rig_.time_s() >= options_.longest_s; }
    [[nodiscard]] const plant::Rig& rig() const { return rig_; }
    /// Whether a period is one step of the plant.
    [[nodiscard]] bool single_steps() const { return plant_steps_ == 1; }
    [[nodiscard]] const Pilot& pilot() const { return pilot_; }
    [[nodiscard]] StopFigures figures() const { return result_; }
    [[nodiscard]] double distance_m() const { return meter_.started() ? meter_.distance_m(rig_) : 0.0; }

  private:
    friend class SessionLanes;

    bool measure();
    void close_period(antiskid::control::State controller);
    void sense();

    SessionOptions options_;
    int plant_steps_;
    plant::Rig rig_;
    Pilot pilot_;
    StopMeter meter_;
    StopFigures result_;
    double safe_s_ = 0.0;
    antiskid::can::RigSample sample_;
};

}  // namespace study
