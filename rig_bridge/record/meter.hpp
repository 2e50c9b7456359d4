/// The figures of a braking maneuver from its measured signals, sample by sample. Pure: no clock, file or bus; the same samples give bit-identical
/// figures. Constant memory, no allocation.
///
///     Meter meter(parameters);
///     for (each control period) meter.feed(sample);
///     Figures figures = meter.figures();
///
/// Counted from the first sample in phase `braking` to standstill, which is found from the flywheel's last edges
/// (EdgeTrack::rest()); after an abort, to the first sample of phase `aborting`, energies until the brake has released and flywheel frames arrive. A
/// second `braking` starts again.
///
/// Way and angle are counted in edges, so that the integrals of eq. (9) need no estimate of speed:
/// E_brake = integral of T_b d theta_w, E_tyre = integral of F_x (R_f d theta_f - r(F_z) d theta_w), which is F_x lambda v dt
/// with the slip of eq. (3) and r(F_z) = r_0 - F_z / k_r.
///
/// Readings of load cells may be old when they reach the bus (PLC, bridge): a reading that was `age` old multiplies the way up to that time, and the
/// way since then is multiplied by it until the next one comes.
///
/// While load cells or encoders are silent, the work is computed from the speeds before and after (WorkBalance); the warning "energy_by_speeds: ..."
/// says how much.
///
/// Their sum must equal the kinetic energy lost, eq. (8); otherwise the figures are invalid and warnings() reports it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/can/layout.hpp"
#include "firmware/can/rig_sample.hpp"
#include "rig_bridge/record/edge_track.hpp"
#include "rig_bridge/record/summary.hpp"
#include "rig_bridge/record/work_balance.hpp"

namespace rig::record {

/// Warning: part of the brake energy was computed from speeds, because load cells or encoders were silent.
inline constexpr std::string_view kEnergyBySpeeds = "energy_by_speeds";

/// Warning: the mean friction is impossible for a brake.
inline constexpr std::string_view kFrictionImplausible = "friction_implausible";

/// End of the warnings that bound the brake energy that the figures lack.
[[nodiscard]] std::string in_no_record(double max_J);

/// Oldest reading of load cells that is assigned to its own time.
inline constexpr double kMaxAge_s = 0.05;

/// Below this pressure a brake counts as released.
inline constexpr double kReleased_Pa = 0.2e6;

/// Parameters of the rig.
struct MeterParameters {
    double wheel_teeth = 60.0;
    double flywheel_teeth = 60.0;
    double flywheel_radius_m = 0.0;    ///< R_f
    double wheel_radius_m = 0.0;       ///< r_0
    double wheel_stiffness_Npm = 0.0;  ///< k_r > 0
    double brake_gain_m3 = 0.0;        ///< A_p N_p N_s R_eff, eq. (5): k_b without friction
    double contact_pressure_Pa = 0.0;  ///< what mu_b is counted above: below it the discs are apart
    double wheel_inertia_kgm2 = 0.0;   ///< J_w
    double flywheel_mass_kg = 0.0;     ///< m = J_f / R_f^2
    double peak_friction = 0.0;        ///< of the surface, eq. (16); 0: it varies along the runway, J_mu is unknown
    double drop_out_mps = 5.0;         ///< mu_b and J_mu end here
    double period_s = 1e-3;            ///< control period: the step of the SYNC number

    // Limits of a valid record; the default values accept everything.
    double wheel_max_radps = std::numeric_limits<double>::infinity();     ///< highest that its encoder can report
    double flywheel_max_radps = std::numeric_limits<double>::infinity();  ///< the same
    double sensor_late_s = std::numeric_limits<double>::infinity();       ///< largest age of a usable reading; an older encoder counts as silent
    /// Allowed difference of brake plus tyre energy from the kinetic energy lost, as share of the kinetic energy at brake-on.
    double energy_band = std::numeric_limits<double>::infinity();
    double friction = 0.0;  ///< expected mean mu_b of the brake; 0: unknown
};

/// One shaft's values from the bus: edges, or a speed if the sensor reports that.
struct ShaftSample {
    bool edges = true;
    std::uint32_t edge_count = 0;
    Time edge_time{};  ///< the sensor's clock
    double speed_radps = 0.0;
    RollOver roll_over{};
    bool reported = true;  ///< false: nothing new of this sensor since the sample before
};

/// Sample of an encoder from its own output.
[[nodiscard]] inline ShaftSample shaft_sample(const antiskid::can::SpeedSample& sample) {
    return {.edge_count = sample.edge_count, .edge_time = sample.edge_time, .speed_radps = static_cast<double>(sample.speed_radps)};
}

/// The values known at one control period.
struct MeterSample {
    double time_s = 0.0;     ///< must not fall
    std::uint8_t phase = 0;  ///< index in antiskid::can::kPhaseNames
    bool braked = false;     ///< phase `braking` was received since the last sample
    ShaftSample wheel;
    ShaftSample flywheel;
    double pressure_Pa = 0.0;
    double vertical_N = 0.0;
    double longitudinal_N = 0.0;
    double brake_torque_Nm = 0.0;
    double load_cells_age_s = 0.0;    ///< of their values when they were sent, up to kMaxAge_s
    bool load_cells_reported = true;  ///< false: nothing new of them since the sample before
    double brake_temperature_C = 0.0;
};

/// The sample with the values rounded as in frames of this layout.
[[nodiscard]] MeterSample as_on_bus(const antiskid::can::Layout& layout, const MeterSample& sample);

class Meter {
  public:
    explicit Meter(const MeterParameters& parameters);

    /// Samples must start at least 50 ms before brake-on: the speed at brake-on is computed from the edges before it.
    void feed(const MeterSample& sample);

    /// The figures so far; final once the phases after braking are reached. All zero before brake-on; undefined ones (mean friction without pressure)
    /// are 0. `peak_temperature_C` is from brake-on to the last sample.
    [[nodiscard]] Figures figures() const;
    /// Problems of the figures: "encoder_restarted: flywheel 1", "energy_unbalanced: ...", "friction_implausible: ..."; empty for a valid record.
    [[nodiscard]] std::vector<std::string> warnings() const;

    [[nodiscard]] bool started() const { return state_ != State::waiting; }
    /// Whether the brake has come on, without a recorded release or standstill.
    [[nodiscard]] bool open() const { return state_ == State::releasing || (state_ == State::braking && !standstill_); }
    /// Rim speed of the flywheel, and the slip of eq. (3), as measured now.
    [[nodiscard]] double speed_mps() const { return flywheel_speed_; }
    [[nodiscard]] double slip() const;
    /// Present kinetic energy of flywheel and wheel.
    [[nodiscard]] double kinetic_energy_J() const;

  private:
    /// A shaft by either kind of sensor.
    class Shaft {
      public:
        Shaft(double edge_pitch, const EdgeLimits& limits) : track_(edge_pitch, limits) {}
        void update(const ShaftSample& sample, double now_s, double scale);
        [[nodiscard]] double way() const { return way_; }
        [[nodiscard]] double speed() const { return speed_; }
        [[nodiscard]] const EdgeTrack& track() const { return track_; }
        [[nodiscard]] bool edges() const { return edges_; }
        [[nodiscard]] std::uint64_t motion_updates() const { return edges_ ? track_.edge_updates() : moving_updates_; }
        [[nodiscard]] double heard_s() const { return edges_ ? track_.heard_s() : heard_s_; }
        /// Instant and way at which it came to rest.
        [[nodiscard]] double rest_s() const;
        [[nodiscard]] double rest_way() const;
        void measure_clock_again() { track_.measure_clock_again(); }

      private:
        EdgeTrack track_;
        bool edges_ = true;
        bool started_ = false;
        double way_ = 0.0;
        double speed_ = 0.0;
        double last_s_ = 0.0;
        double heard_s_ = -std::numeric_limits<double>::infinity();
        double moving_s_ = 0.0;
        std::uint64_t moving_updates_ = 0;
    };
    enum class State : std::uint8_t { waiting, braking, releasing, over };

    /// Integrals over time since brake-on, as they stood at a sample.
    struct Sums {
        double time_s = 0.0;
        double torque_Nms = 0.0;
        double load_Ns = 0.0;
        double pressure_Pas = 0.0;
    };
    [[nodiscard]] Figures now() const;
    [[nodiscard]] bool released(const MeterSample& sample) const;
    /// Not below drop-out, nor where the pressure is not known: friction counts.
    [[nodiscard]] bool sliding() const { return !dropped_out_ && !hole_; }
    [[nodiscard]] Work by_speeds(const MeterSample& sample, bool both_reported);
    [[nodiscard]] bool hears(const Shaft& shaft, double now_s) const { return now_s - shaft.heard_s() <= parameters_.sensor_late_s; }
    /// From brake-on down to these speeds.
    [[nodiscard]] double kinetic_lost_J(double v_mps, double omega_radps) const;
    void start(const MeterSample& sample);
    void integrate(const MeterSample& sample);
    [[nodiscard]] Sums sums_at(double time_s) const;

    static constexpr std::size_t kTail = 1024;

    MeterParameters parameters_;
    Shaft wheel_;     // rad
    Shaft flywheel_;  // m on the rim
    double flywheel_speed_ = 0.0;
    State state_ = State::waiting;
    bool fed_ = false;
    bool dropped_out_ = false;
    bool standstill_ = false;
    MeterSample last_;
    double last_wheel_way_ = 0.0, last_flywheel_way_ = 0.0;
    double last_wheel_radps_ = 0.0, last_flywheel_mps_ = 0.0;
    double flywheel_since_s_ = 0.0;  // it was heard without a silence
    double rolling_ = 1.0;           // 1 - lambda, as it last was known
    double start_s_ = 0.0, start_way_m_ = 0.0, start_mps_ = 0.0, start_radps_ = 0.0;
    Sums sums_;
    WorkBalance work_balance_;
    /// What torque and force act along.
    struct Way {
        double time_s = 0.0, sliding_s = 0.0;
        double angle = 0.0, metres = 0.0, sliding_m = 0.0;
        void add(const Way& other) {
            time_s += other.time_s;
            sliding_s += other.sliding_s;
            angle += other.angle;
            metres += other.metres;
            sliding_m += other.sliding_m;
        }
    };
    /// The newest new reading of the load cells, and the way since its time.
    struct Knot {
        double torque_Nm = 0.0, vertical_N = 0.0, longitudinal_N = 0.0;
        Way way{};
    };
    [[nodiscard]] static Knot knot_at(const MeterSample& sample) {
        return {.torque_Nm = sample.brake_torque_Nm, .vertical_N = sample.vertical_N, .longitudinal_N = sample.longitudinal_N};
    }
    /// With the mean of both readings.
    [[nodiscard]] Work by_cells(const Knot& from, const MeterSample& to, const Way& way) const;
    Knot knot_;
    /// Steps that the newest reading is too old to know. As many as a period of 1 ms has in kMaxAge_s.
    struct Step {
        double time_s = 0.0;  // its end
        Way way{};
        Work by_speeds{};
    };
    static constexpr std::size_t kAhead = 64;
    /// Moves the steps up to `time_s` to the knot; their work by speeds.
    Work catch_up(double time_s);
    [[nodiscard]] WorkAhead ahead(const MeterSample& sample) const;
    std::array<Step, kAhead> steps_{};
    std::size_t first_step_ = 0, steps_ahead_ = 0;
    double age_s_ = 0.0;                                       // of the newest reading when it came
    bool wheel_reported_ = false, flywheel_reported_ = false;  // since both were: their frames need not come in the same sample
    /// Since both shafts and their speeds were last known: the step before, unless there was a gap.
    struct Span {
        double flywheel_mps = 0.0, wheel_radps = 0.0;  // at its beginning
        double angle = 0.0, metres = 0.0;
        double reported_s = 0.0;  // newest readings of both
        bool gap = false;
        double back_s = 0.0;  // readings came again
        Work given{};         // the steps so far
        double unknown_J = 0.0;
    };
    [[nodiscard]] Span span_at(double time_s) const { return {.flywheel_mps = flywheel_speed_, .wheel_radps = wheel_.speed(), .reported_s = time_s}; }
    Span span_;
    double unknown_J_ = 0.0;                                   // of closed spans: the brake's or the tyre's
    bool hole_ = false;                                        // in the record, or speeds are not yet known after one
    double sliding_pressure_Pas_ = 0.0, sliding_way_m_ = 0.0;  // down to drop-out
    double ended_s_ = 0.0;
    double peak_temperature_C_ = 0.0;
    Figures final_;
    std::uint64_t motion_updates_ = 0;
    std::vector<Sums> tail_;  // since the flywheel's last edge: standstill lies among them; capacity kTail from the start
};

}  // namespace rig::record
