#include "plant_sim/study/faults/sample_fault.hpp"

#include <algorithm>

#include "firmware/control/types.hpp"

namespace faults {

namespace {

using antiskid::control::Law;

constexpr Scale kPressure_Pa{.min_bias = 0.1e6, .max_bias = 20e6, .full = 25e6};
constexpr Scale kDemand_Pa{.min_bias = 0.1e6, .max_bias = 20e6, .full = 32e6};
constexpr Scale kSlipReference{.min_bias = 0.01, .max_bias = 0.5, .full = 1.0};

Scale scale_of(Signal signal) {
    return signal == Signal::pressure ? kPressure_Pa : signal == Signal::demand ? kDemand_Pa : kSlipReference;
}

/// Full scale of the encoders' electronics.
constexpr double kFull_radps = 400.0;

double teeth_of(Signal signal, const rig::RigParameters& rig) {
    return signal == Signal::flywheel ? rig.flywheel_encoder.teeth : rig.wheel_encoder.teeth;
}

}  // namespace

SampleFault::SampleFault(const Fault& fault, const rig::RigParameters& rig, double period_s)
    : fault_(fault),
      value_(fault, scale_of(fault.what.signal)),
      switch_(fault),
      encoder_(fault, teeth_of(fault.what.signal, rig), kFull_radps),
      flywheel_radius_m_(rig.flywheel_radius_m),
      period_s_(period_s) {}

void SampleFault::apply_law(antiskid::can::ManeuverSample& maneuver, rig::Random& random) const {
    constexpr unsigned kLaws = antiskid::control::kLawCount;
    const auto law = static_cast<unsigned>(maneuver.law);
    unsigned wrong = law;
    if (fault_.what.kind == Kind::bias) wrong = (law + 1U) % kLaws;
    if (fault_.what.kind == Kind::saturation) wrong = fault_.negative ? kLaws : 7U;
    if (fault_.what.kind == Kind::spike && uniform(random) < fault_.share) wrong = static_cast<unsigned>(random.bits() % kLaws);
    maneuver.law = static_cast<Law>(wrong);
}

void SampleFault::apply(antiskid::can::RigSample& sample, const study::RigSession& session, bool active, rig::Random& random) {
    const plant::Rig& rig = session.rig();
    const double now_s = rig.time_s();
    const auto number = [&](float& value) { value = static_cast<float>(value_.apply(static_cast<double>(value), active, random)); };
    if (of_frame(fault_.what.kind) && fault_.what.signal != Signal::emergency_stop) return;
    switch (fault_.what.signal) {
        case Signal::wheel:
            sample.wheel = encoder_.apply(sample.wheel, rig.wheel().omega_radps, now_s, period_s_, active, random);
            break;
        case Signal::flywheel:
            sample.flywheel = encoder_.apply(sample.flywheel, rig.wheel().v_mps / flywheel_radius_m_, now_s, period_s_, active, random);
            break;
        case Signal::pressure:
            number(sample.pressure_Pa);
            break;
        case Signal::demand:
            number(sample.maneuver.demand_Pa);
            break;
        case Signal::slip_reference:
            number(sample.maneuver.slip_reference);
            break;
        case Signal::arm:
            sample.maneuver.arm = switch_.apply(sample.maneuver.arm, active, random);
            break;
        case Signal::weight_on_wheels:
            sample.maneuver.weight_on_wheels = switch_.apply(sample.maneuver.weight_on_wheels, active, random);
            break;
        case Signal::law:
            if (active) apply_law(sample.maneuver, random);
            break;
        case Signal::emergency_stop:
            if (active) pressed_until_s_ = std::max(pressed_until_s_, now_s + (pressed_until_s_ < 0.0 ? kPressed_s : 0.0));
            sample.emergency_stop = active || now_s < pressed_until_s_;
            break;
        default:
            break;
    }
}

}  // namespace faults
