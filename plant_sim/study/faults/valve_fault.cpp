#include "plant_sim/study/faults/valve_fault.hpp"

#include <algorithm>
#include <cmath>

namespace faults {

namespace {
constexpr Scale kCurrent_mA{.min_bias = 0.2, .max_bias = 40.0, .full = 40.0};
}

ValveFault::ValveFault(const Fault& fault, double period_s) : fault_(fault), value_(fault, kCurrent_mA), period_s_(period_s) {}

double ValveFault::apply(double current_mA, bool active, rig::Random& random) {
    if (fault_.what.signal == Signal::valve_current) return std::clamp(value_.apply(current_mA, active, random), 0.0, kCurrent_mA.full);
    if (fault_.what.signal != Signal::valve || !active) return spool_mA_ = current_mA;
    switch (fault_.what.kind) {
        case Kind::stuck:
            return spool_mA_;
        case Kind::slow: {
            const double lag_s = between(0.02, 1.0, fault_.strength);
            spool_mA_ += (current_mA - spool_mA_) * (1.0 - std::exp(-period_s_ / lag_s));
            return spool_mA_;
        }
        default:
            return fault_.negative ? std::max(current_mA, between(1.0, 15.0, fault_.strength))
                                   : current_mA * (1.0 - between(0.05, 0.6, fault_.strength));
    }
}

}  // namespace faults
