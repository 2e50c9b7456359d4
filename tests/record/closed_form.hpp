/// A maneuver whose every figure is known in closed form, as frames on the bus: flywheel at v_0, then constant deceleration in one
/// or two pieces to rest, constant slip, torque, load, force and pressure.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "firmware/can/rig_port.hpp"
#include "rig_bridge/record/meter.hpp"
#include "tests/can/layouts.hpp"

namespace record_test {

using antiskid::can::Frame;
using antiskid::can::RigPort;
using antiskid::can::RigSample;
using antiskid::control::Time;

inline constexpr rig::record::MeterParameters kRig{.wheel_teeth = 60.0,
                                                   .flywheel_teeth = 60.0,
                                                   .flywheel_radius_m = 0.6,
                                                   .wheel_radius_m = 0.309,
                                                   .wheel_stiffness_Npm = 2.7e6,
                                                   .brake_gain_m3 = 1.2e-3,
                                                   .wheel_inertia_kgm2 = 1.3,
                                                   .flywheel_mass_kg = 633.6,
                                                   .peak_friction = 1.17,
                                                   .drop_out_mps = 5.0,
                                                   .period_s = 1e-3};

/// kRig with what config/controller.toml says of its encoders.
inline rig::record::MeterParameters gated() {
    rig::record::MeterParameters p = kRig;
    p.wheel_max_radps = 400.0;
    p.flywheel_max_radps = 250.0;
    p.sensor_late_s = 0.02;
    p.energy_band = 0.1;
    return p;
}

struct ClosedForm {
    double v0_mps = 54.86;
    double a1_mps2 = 3.242;  ///< down to `change_mps`, from there on a2
    double a2_mps2 = 3.242;
    double change_mps = 5.0;
    double slip = 0.03;
    double torque_Nm = 630.0;
    double load_N = 23'532.0;
    double force_N = 2048.0;
    double pressure_Pa = 2.0e6;
    double before_s = 2.0;       ///< from the first sample to brake-on, at v0
    double tooth = 0.37;         ///< where the first edge lies, 0 to 1 of a pitch
    double standstill_s = 0.05;  ///< the phase comes this long after rest
    double jitter_s = 0.0;       ///< of edge stamps
    double slowest_edges_hz = 10.0;
    double pitch_error = 0.0;  ///< standard deviation of a tooth's place, of a pitch
    std::uint32_t number = 17;

    [[nodiscard]] double radius_m() const { return kRig.wheel_radius_m - load_N / kRig.wheel_stiffness_Npm; }
    [[nodiscard]] double change_at_s() const { return (v0_mps - change_mps) / a1_mps2; }
    [[nodiscard]] double duration_s() const { return change_at_s() + change_mps / a2_mps2; }
    [[nodiscard]] double length_m() const {
        return (v0_mps * v0_mps - change_mps * change_mps) / (2.0 * a1_mps2) + change_mps * change_mps / (2.0 * a2_mps2);
    }
    [[nodiscard]] double rest_s() const { return before_s + duration_s(); }
    [[nodiscard]] double speed(double t) const {
        const double s = t - before_s;
        if (s <= 0.0) return v0_mps;
        if (s < change_at_s()) return v0_mps - a1_mps2 * s;
        return std::max(change_mps - a2_mps2 * (s - change_at_s()), 0.0);
    }
    /// When the flywheel's rim has gone `x` since the first sample; x below the way to rest.
    [[nodiscard]] double when(double x) const {
        const double braking = x - v0_mps * before_s;
        if (braking <= 0.0) return x / v0_mps;
        const double first = (v0_mps * v0_mps - change_mps * change_mps) / (2.0 * a1_mps2);
        const auto time = [](double v, double a, double way) { return 2.0 * way / (v + std::sqrt(std::max(v * v - 2.0 * a * way, 0.0))); };
        if (braking < first) return before_s + time(v0_mps, a1_mps2, braking);
        return before_s + change_at_s() + time(change_mps, a2_mps2, braking - first);
    }
};

/// All edges of one encoder that its pick-up sees.
class Edges {
  public:
    Edges(const ClosedForm& c, double pitch_m, unsigned seed) {
        std::mt19937 random(seed);
        std::normal_distribution<double> noise;
        const double way = c.v0_mps * c.before_s + c.length_m();
        for (double n = c.tooth;; n += 1.0) {
            const double x = (n + c.pitch_error * noise(random)) * pitch_m;
            if (x >= way) break;
            const double t = c.when(std::max(x, 0.0));
            if (c.speed(t) / pitch_m < c.slowest_edges_hz) break;
            times_.push_back(t + c.jitter_s * noise(random));
        }
    }
    /// As the electronics have it at `t`. `clock_s` of the sensor is what it likes.
    antiskid::can::SpeedSample at(double t, double clock_s) {
        while (next_ < times_.size() && times_[next_] <= t) ++next_;
        const double stamp = next_ == 0 ? 0.0 : times_[next_ - 1];
        return {
            .edge_count = static_cast<std::uint32_t>(next_ + 65'000), .edge_time = Time{std::llround((stamp + clock_s) * 1e9)}, .speed_radps = 0.0F};
    }
    [[nodiscard]] double last_s() const { return times_.back(); }

  private:
    std::vector<double> times_;
    std::size_t next_ = 0;
};

/// The bus of that maneuver, as it was recorded: stamps in wall-clock ns.
class Recording {
  public:
    /// `change`: what the sensors say instead at a time.
    using Change = std::function<void(double t, RigSample& sample)>;

    Recording(const ClosedForm& c, bool sync, unsigned seed = 1, const Change& change = {}) {
        const double pitch = 2.0 * std::numbers::pi / 60.0;
        Edges flywheel(c, pitch * kRig.flywheel_radius_m, seed);
        // The wheel turns slower by the slip: its edges lie further apart on the flywheel's way.
        Edges wheel(c, pitch * c.radius_m() / (1.0 - c.slip), seed + 1);
        naive_rest_s = flywheel.last_s() - c.before_s;
        RigPort sensors(can_test::ours(), Time{1'000'000}, antiskid::can::kFromRigSensors);
        RigPort bridge(can_test::ours(), Time{1'000'000}, antiskid::can::kFromBridge);
        std::mt19937 random(seed);
        std::uniform_int_distribution<std::int64_t> late(0, 150'000);
        const double end_s = c.rest_s() + c.standstill_s + 0.5;
        const auto steps = static_cast<std::uint32_t>(end_s * 1000.0);
        for (std::uint32_t n = 1; n <= steps; ++n) {
            const double t = 1e-3 * n;
            const bool braking = begun(c, t) && t <= c.rest_s();
            RigSample sample;
            sample.flywheel = flywheel.at(t, 1234.5);
            sample.wheel = wheel.at(t, -77.25);
            sample.pressure_Pa = begun(c, t) ? static_cast<float>(c.pressure_Pa) : 0.0F;
            sample.load_cells = {.vertical_N = static_cast<float>(c.load_N),
                                 .longitudinal_N = braking ? static_cast<float>(c.force_N) : 0.0F,
                                 .brake_torque_Nm = braking ? static_cast<float>(c.torque_Nm) : 0.0F};
            sample.maneuver_state = {.phase = phase(c, t), .number = c.number, .brake_temperature_C = temperature(t)};
            if (change) change(t, sample);
            std::int64_t stamp = 1'436'509'053'000'000'000 + std::int64_t{n} * 1'000'000 + (sync ? 0 : late(random));
            const auto add = [&](std::span<const Frame> some) {
                for (Frame frame : some) {
                    frame.received = Time{stamp += 60'000};
                    frames.push_back(frame);
                }
            };
            std::array<Frame, RigPort::kMaxFrames> due;
            add({due.data(), bridge.due_frames(sample, due)});
            add({due.data(), sensors.due_frames(sample, due)});
            if (sync) {
                const Frame frame = sensors.sync(n);
                add({&frame, 1});
            }
        }
    }

    /// From the sample at brake-on, which comes at a whole number of periods.
    static bool begun(const ClosedForm& c, double t) { return t > c.before_s - 1e-9; }
    static std::uint8_t phase(const ClosedForm& c, double t) {
        if (t > c.rest_s() + c.standstill_s + 0.2) return 6;
        if (t > c.rest_s() + c.standstill_s) return 5;
        return begun(c, t) ? 4 : 3;
    }
    static float temperature(double t) { return 20.0F + 10.0F * std::floor(static_cast<float>(t)); }

    std::vector<Frame> frames;
    double naive_rest_s = 0.0;  ///< duration by the last edge alone
};

}  // namespace record_test
