#include "plant_sim/study/faults/catalogue.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace faults {

namespace {

std::vector<Pair> all_pairs() {
    using enum Kind;
    std::vector<Pair> pairs;
    const auto add = [&pairs](Signal signal, std::span<const Kind> kinds) {
        for (const Kind kind : kinds) pairs.push_back({signal, kind});
    };
    constexpr std::array kFrame{drop, delay, jitter, corrupt, replayed, duplicated, reordered, wrong_counter};
    constexpr std::array kEncoder{freeze, bias, noise, spike, saturation, missing_tooth, wrong_sign, clock_step};
    constexpr std::array kValue{freeze, bias, noise, spike, saturation, wrong_sign};
    constexpr std::array kSwitch{freeze, noise, spike, wrong_sign};
    constexpr std::array kCode{bias, spike, saturation};
    constexpr std::array kHydraulics{stuck, slow, leaking};
    constexpr std::array kMachine{overrun, bus_off, clock_step};
    for (const Signal encoder : {Signal::wheel, Signal::flywheel}) {
        add(encoder, kFrame);
        add(encoder, kEncoder);
    }
    add(Signal::pressure, kFrame);
    add(Signal::pressure, kValue);
    add(Signal::maneuver, kFrame);
    add(Signal::demand, kValue);
    add(Signal::slip_reference, kValue);
    add(Signal::arm, kSwitch);
    add(Signal::weight_on_wheels, kSwitch);
    add(Signal::law, kCode);
    add(Signal::heartbeat, kFrame);
    add(Signal::emergency_stop, kFrame);
    add(Signal::valve_command, kFrame);
    add(Signal::valve_current, kValue);
    add(Signal::valve, kHydraulics);
    add(Signal::controller, kMachine);
    return pairs;
}

}  // namespace

std::span<const Pair> catalogue() {
    static const std::vector<Pair> pairs = all_pairs();
    return pairs;
}

double between(double low, double high, double strength) {
    return low * std::pow(high / low, strength);
}

Fault draw(Pair what, rig::Random& random) {
    constexpr double kRarest = 0.02;
    constexpr double kShortest_s = 5e-3;
    constexpr double kLongest_s = 1.0;
    Fault fault{.what = what};
    fault.strength = random.uniform();
    const double share = random.uniform();
    fault.share = share < 0.4 ? 1.0 : between(kRarest, 1.0, random.uniform());
    // An emergency stop of which no frame arrives cannot be received: for a cut wire the rig needs its own emergency chain.
    constexpr double kMaxOfStop = 0.9;
    if (what.signal == Signal::emergency_stop) fault.share = std::min(fault.share, kMaxOfStop);
    fault.negative = random.uniform() < 0.5;
    const bool lasting = random.uniform() < 0.5;
    fault.lasts_s = lasting ? Fault::kForGood : between(kShortest_s, kLongest_s, random.uniform());
    return fault;
}

}  // namespace faults
