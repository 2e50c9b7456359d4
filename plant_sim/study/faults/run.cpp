#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/can/rig_sample.hpp"
#include "firmware/control/controller.hpp"
#include "firmware/control/types.hpp"
#include "plant_sim/model/rig.hpp"
#include "plant_sim/study/faults/fault_campaign.hpp"
#include "plant_sim/study/faults/frame_fault.hpp"
#include "plant_sim/study/faults/machine_fault.hpp"
#include "plant_sim/study/faults/value_fault.hpp"
#include "plant_sim/study/faults/valve_driver.hpp"
#include "plant_sim/study/faults/valve_fault.hpp"
#include "plant_sim/study/loop.hpp"
#include "plant_sim/study/rig_session.hpp"

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

/// bias of the law: the next law; spike: a random law in a share of the periods; saturation: the largest code. An emergency stop is pressed as long
/// as the fault lasts, at least for kPressed_s.
class SampleFault {
  public:
    static constexpr double kPressed_s = 0.5;

    SampleFault(const Fault& fault, const rig::RigParameters& rig, double period_s)
        : fault_(fault),
          value_(fault, scale_of(fault.what.signal)),
          switch_(fault),
          encoder_(fault, teeth_of(fault.what.signal, rig), kFull_radps),
          flywheel_radius_m_(rig.flywheel_radius_m),
          period_s_(period_s) {}

    void apply(antiskid::can::RigSample& sample, const study::RigSession& session, bool active, rig::Random& random) {
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

  private:
    void apply_law(antiskid::can::ManeuverSample& maneuver, rig::Random& random) const {
        constexpr unsigned kLaws = antiskid::control::kLawCount;
        const auto law = static_cast<unsigned>(maneuver.law);
        unsigned wrong = law;
        if (fault_.what.kind == Kind::bias) wrong = (law + 1U) % kLaws;
        if (fault_.what.kind == Kind::saturation) wrong = fault_.negative ? kLaws : 7U;
        if (fault_.what.kind == Kind::spike && random.uniform() < fault_.share) wrong = static_cast<unsigned>(random.bits() % kLaws);
        maneuver.law = static_cast<Law>(wrong);
    }

    Fault fault_;
    ValueFault value_;
    SwitchFault switch_;
    EncoderFault encoder_;
    double flywheel_radius_m_;
    double period_s_;
    double pressed_until_s_ = -1.0;
};

using antiskid::can::ControllerPort;
using antiskid::can::Frame;
using antiskid::can::RigPort;
using antiskid::can::Role;
using antiskid::control::Command;
using antiskid::control::Controller;
using antiskid::control::Time;

/// Message affected by a bus fault of the signal.
Role role_of(Signal signal) {
    switch (signal) {
        case Signal::wheel:
            return Role::wheel;
        case Signal::flywheel:
            return Role::flywheel;
        case Signal::pressure:
            return Role::pressure;
        case Signal::heartbeat:
            return Role::rig_heartbeat;
        case Signal::emergency_stop:
            return Role::emergency_stop;
        case Signal::valve_command:
            return Role::valve;
        default:
            return Role::maneuver;
    }
}

/// Bus, valve driver and fault.
class FaultLink {
  public:
    FaultLink(const FaultPlan& plan, const Case& c)
        : layout_(plan.layout),
          fault_(c.fault),
          random_(c.fault_seed),
          rig_port_(plan.layout, study::period_of(plan.controller)),
          port_(plan.layout, study::period_of(plan.controller)),
          message_(plan.layout[role_of(c.fault.what.signal)].id),
          on_bus_(of_frame(c.fault.what.kind)),
          frames_(c.fault, plan.layout, role_of(c.fault.what.signal)),
          sample_(c.fault, plan.surfaces[c.surface].rig, static_cast<double>(plan.controller.period_s)),
          valve_(c.fault, static_cast<double>(plan.controller.period_s)),
          machine_(c.fault) {}

    /// Sets whether the fault acts in the following cycles.
    void set_active(bool active) { active_ = active; }
    [[nodiscard]] const Command& command() const { return command_; }
    /// Inputs of the controller in the last cycle; null: it missed the cycle.
    [[nodiscard]] const antiskid::control::Sensors* given() const { return missed_ == 0 ? &port_.sensors() : nullptr; }
    [[nodiscard]] const antiskid::can::ControllerView& view() const { return rig_port_.controller(); }
    [[nodiscard]] double driver_mA() const { return driver_.current_mA(); }
    /// The effective current, which may differ from the driver's.
    [[nodiscard]] double current_mA() const { return current_mA_; }
    [[nodiscard]] antiskid::control::State state() const { return command_.state; }
    /// Whether the valve's driver has a valid command.
    [[nodiscard]] bool received() const { return driver_.has_command(); }
    /// The demand sent; 0 if it does not arm, or the wheel carries no load.
    [[nodiscard]] double asked_Pa() const {
        return asked_.arm && asked_.weight_on_wheels ? layout_.maneuver.demand_Pa.rounded(static_cast<double>(asked_.demand_Pa)) : 0.0;
    }

    const Command& cycle(const study::RigSession& session, Controller& controller, Time now, const study::RunResult& result) {
        const auto step = static_cast<std::int64_t>(result.steps);
        const MachineFault::Effect effect = machine_.effect(active_, random_);
        send_samples(session, step, now, effect);
        std::uint32_t answers = 0;
        std::array<Frame, ControllerPort::kMaxFrames> answer{};
        if (effect.misses_period) {
            ++missed_;
        } else {
            for (const Frame& frame : inbox_) port_.accept(frame);
            inbox_.clear();
            port_.note_link({.up = !effect.bus_off, .bus_off = effect.bus_off});
            port_.note_missed_periods(missed_);
            missed_ = 0;
            command_ = controller.step(port_.sensors(), now + effect.clock);
            port_.clear_one_shots();
            answers = static_cast<std::uint32_t>(port_.due_frames(command_, answer));
        }
        for (std::uint32_t i = 0; i < answers; ++i) {
            answer[i].received = now;
            if (effect.bus_off) continue;
            if (on_bus_ && answer[i].id == message_)
                frames_.send(answer[i], active_, step, random_);
            else
                rig_port_.accept(answer[i]);
        }
        if (on_bus_ && fault_.what.signal == Signal::valve_command) {
            while (auto frame = frames_.receive(step)) {
                frame->received = now;
                rig_port_.accept(*frame);
            }
        }
        driver_.update(rig_port_.controller(), rig_port_.stats(Role::valve), now);
        current_mA_ = valve_.apply(driver_.current_mA(), active_, random_);
        return command_;
    }

  private:
    void send_samples(const study::RigSession& session, std::int64_t step, Time now, const MachineFault::Effect& effect) {
        antiskid::can::RigSample sample = session.sample();
        sample.load_cells = session.load_cells();
        sample_.apply(sample, session, active_, random_);
        asked_ = sample.maneuver;
        std::array<Frame, RigPort::kMaxFrames> sent{};
        const std::size_t count = rig_port_.due_frames(sample, sent);
        const auto arrive = [&](Frame frame) {
            frame.received = now + effect.clock + effect.stamps;
            if (!effect.bus_off) inbox_.push_back(frame);
        };
        for (std::size_t i = 0; i < count; ++i) {
            if (on_bus_ && sent[i].id == message_)
                frames_.send(sent[i], active_, step, random_);
            else
                arrive(sent[i]);
        }
        if (fault_.what.signal == Signal::valve_command) return;
        while (const auto frame = frames_.receive(step)) arrive(*frame);
    }

    const antiskid::can::Layout& layout_;
    Fault fault_;
    rig::Random random_;
    bool active_ = false;
    RigPort rig_port_;
    ControllerPort port_;
    std::uint32_t message_;
    bool on_bus_;
    FrameFault frames_;
    SampleFault sample_;
    ValveFault valve_;
    MachineFault machine_;
    std::vector<Frame> inbox_;
    antiskid::can::ManeuverSample asked_;
    Command command_;
    ValveDriver driver_;
    double current_mA_ = 0.0;
    std::uint32_t missed_ = 0;
};

study::Loop<FaultLink> loop_of(const FaultPlan& plan, const Case& c, double longest_s) {
    study::SessionOptions session = plan.session(c);
    session.longest_s = longest_s;
    return {plan.controller, plan.surfaces[c.surface].rig, session, FaultLink(plan, c)};
}

constexpr double kLongest_s = 600.0;

}  // namespace

FaultFree run_fault_free(const FaultPlan& plan, const Case& c) {
    study::Loop<FaultLink> loop = loop_of(plan, c, kLongest_s);
    const study::RunResult run = loop.run({});
    if (!run.faults.empty() || !loop.session().rig().standstill())
        throw std::runtime_error(fmt::format(
            "the stop on {}, sensor seed {}, names faults or does not come to rest without any fault: nothing can be said about it with one",
            plan.surfaces[c.surface].name, c.sensor_seed));
    return {.distance_m = run.figures.stop_distance_m, .lasts_s = loop.session().rig().time_s(), .named = run.faults};
}

Result run_one(const FaultPlan& plan, const Case& c, const FaultFree& sound, const PeriodObserver& on_period) {
    constexpr double kPatience = 2.0;  // times the length of the fault-free run: nothing brakes any more
    study::Loop<FaultLink> loop = loop_of(plan, c, kPatience * sound.lasts_s);
    study::RigSession& session = loop.session();
    const plant::Rig& rig = session.rig();
    FaultLink& link = loop.link();
    Judge judge({}, {.sound_distance_m = sound.distance_m,
                     .safe_mA = static_cast<double>(plan.controller.valve.safe_current_mA),
                     .changed_wish = changes_wish(c.fault.what.signal),
                     .emergency_stop = c.fault.what.signal == Signal::emergency_stop});
    Result result;
    FaultStart beginning(c, plan.drop_out_mps);
    bool begun = false;
    double ends_s = 0.0;
    while (!session.done()) {
        const double time_s = rig.time_s();
        if (!begun && beginning.reached(session)) {
            begun = true;
            ends_s = time_s + c.fault.lasts_s;
            result.begun_s = time_s;
            result.begun_mps = rig.wheel().v_mps;
        }
        link.set_active(begun && time_s < ends_s);
        loop.control();
        session.advance(link.current_mA(), link.state());
        if (on_period) on_period({session, link.view(), link.driver_mA(), link.given(), link.command(), begun});
        if (!begun) continue;
        judge.observe({.period_s = static_cast<double>(plan.controller.period_s),
                       .distance_m = session.distance_m(),
                       .v_mps = rig.wheel().v_mps,
                       .slip = rig.forces().slip,
                       .pressure_Pa = rig.pressure_Pa(),
                       .asked_Pa = link.asked_Pa(),
                       .driver_mA = link.driver_mA(),
                       .state = link.state(),
                       .named = link.command().faults,
                       .received = link.received()});
    }
    result.verdict = judge.verdict(rig.standstill());
    return result;
}

}  // namespace faults
