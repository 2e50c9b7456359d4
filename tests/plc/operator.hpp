/// Somebody who runs a served rig by its registers, as the bridge does.
#pragma once

#include <cmath>

#include "plant_sim/plc/load_served_rig.hpp"

namespace plc_test {

using rig::Commanded;
using rig::Measured;

inline rig::LoadedRig loaded(plc::Bench bench) {
    rig::ManeuverChoice choice;
    choice.maneuver = bench == plc::Bench::endurance ? rig::kEndurance : "heavy";
    choice.carrier = rig::Carrier::flywheel;
    return rig::load_rig("config", choice);
}

class Operator {
  public:
    explicit Operator(plc::Bench bench, std::uint64_t seed = 1) : Operator(bench, plc::load_served_rig("config", bench), seed) {}
    Operator(plc::Bench bench, const plc::ServedRigOptions& options, std::uint64_t seed) : plant(loaded(bench)), rig(plant, options, seed) {}

    struct Wish {
        bool drive = false;
        double speed_mps = 0.0;
        bool advance = false;
        bool load = false;
        bool reset = false;
    };
    /// Commits; the law of the load is the maneuver's. Acts at the next scan.
    void wish(const Wish& w) {
        rig::at(registers, Commanded::drive_enable) = w.drive ? 1.0 : 0.0;
        rig::at(registers, Commanded::flywheel_speed_mps) = w.speed_mps;
        rig::at(registers, Commanded::sledge_advance) = w.advance ? 1.0 : 0.0;
        rig::at(registers, Commanded::load_enable) = w.load ? 1.0 : 0.0;
        rig::at(registers, Commanded::reset) = w.reset ? 1.0 : 0.0;
        rig::at(registers, Commanded::load_base_N) = plant.rig.load.base_N;
        rig::at(registers, Commanded::load_lift_Ns2pm2) = plant.rig.load.lift_Ns2pm2;
        rig::at(registers, Commanded::commit) += 1.0;
    }

    void tick(double current_mA = 0.0) {
        if (alive && ++ticks_ % 50 == 1) rig::at(registers, Commanded::bridge_watchdog) += 1.0;
        rig.command(registers);
        rig.advance(current_mA);
    }
    void run(double seconds, double current_mA = 0.0) {
        for (auto left = std::lround(seconds * 1e3); left > 0; --left) tick(current_mA);
    }
    /// Ticks until `done`; false when that took longer than `limit_s`.
    template <typename Done>
    [[nodiscard]] bool until(const Done& done, double limit_s, double current_mA = 0.0) {
        for (auto left = std::lround(limit_s * 1e3); !done(); --left) {
            if (left <= 0) return false;
            tick(current_mA);
        }
        return true;
    }
    [[nodiscard]] double v() const { return rig.rig().wheel().v_mps; }
    [[nodiscard]] double measured(Measured q) const { return rig::at(rig.measured(), q); }

    rig::LoadedRig plant;
    plc::ServedRig rig;
    rig::CommandedValues registers{};
    bool alive = true;

  private:
    long ticks_ = 0;
};

/// Spin-up, touchdown, a stop at constant current, retract.
inline bool maneuver(Operator& op, double speed_mps, double current_mA) {
    op.wish({.drive = true, .speed_mps = speed_mps});
    if (!op.until([&op, speed_mps] { return op.v() > speed_mps - 0.05; }, 60.0)) return false;
    op.wish({.advance = true, .load = true});
    if (!op.until([&op] { return op.rig.wheel_on_rim(); }, 10.0)) return false;
    op.run(1.5);
    if (!op.until([&op] { return op.rig.rig().standstill(); }, 120.0, current_mA)) return false;
    op.wish({});
    return op.until([&op] { return op.rig.idle(); }, 30.0);
}

}  // namespace plc_test
