#include "plant_sim/study/faults/machine_fault.hpp"

namespace faults {

using antiskid::control::Time;

MachineFault::Effect MachineFault::effect(bool active, rig::Random& random) {
    Effect effect{.clock = clock_};
    if (fault_.what.signal != Signal::controller || !active) return effect;
    const std::int64_t period = periods_++;
    switch (fault_.what.kind) {
        case Kind::overrun: {
            const auto burst = static_cast<std::int64_t>(between(1.0, 300.0, fault_.strength));
            effect.misses_period = fault_.negative ? period / burst % 2 == 0 : random.uniform() < fault_.share;
            break;
        }
        case Kind::bus_off: {
            constexpr std::int64_t kStretch = 20;
            if (period % kStretch == 0) off_ = !fault_.negative || random.uniform() < fault_.share;
            effect.bus_off = off_;
            break;
        }
        default: {
            const Time step{static_cast<std::int64_t>(between(1e5, 1e10, fault_.strength))};
            if (!fault_.negative)
                effect.clock = clock_ = step;
            else
                effect.stamps = fault_.share < 0.5 ? -step : step;
            break;
        }
    }
    return effect;
}

}  // namespace faults
