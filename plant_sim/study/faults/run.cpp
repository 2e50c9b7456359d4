#include <fmt/format.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/control/controller.hpp"
#include "plant_sim/study/faults/fault_campaign.hpp"
#include "plant_sim/study/faults/frame_fault.hpp"
#include "plant_sim/study/faults/machine_fault.hpp"
#include "plant_sim/study/faults/sample_fault.hpp"
#include "plant_sim/study/faults/valve_driver.hpp"
#include "plant_sim/study/faults/valve_fault.hpp"
#include "plant_sim/study/loop.hpp"

namespace faults {

namespace {

using antiskid::can::ControllerPort;
using antiskid::can::Frame;
using antiskid::can::RigPort;
using antiskid::can::Role;
using antiskid::control::Command;
using antiskid::control::Controller;
using antiskid::control::Time;

/// Whose frames a signal's bus faults hit.
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

/// Rig, bus, controller and valve driver, and the fault wherever it sits.
class Bench {
  public:
    Bench(const FaultPlan& plan, const Case& c, double longest_s)
        : plan_(plan),
          fault_(c.fault),
          random_(c.fault_seed),
          session_(plan.surfaces[c.surface].rig, options(plan, c, longest_s)),
          controller_(plan.controller),
          period_(study::period_of(plan.controller)),
          rig_port_(plan.layout, period_),
          port_(plan.layout, period_),
          message_(plan.layout[role_of(c.fault.what.signal)].id),
          on_bus_(of_frame(c.fault.what.kind)),
          frames_(c.fault, plan.layout, role_of(c.fault.what.signal)),
          sample_(c.fault, plan.surfaces[c.surface].rig, static_cast<double>(plan.controller.period_s)),
          valve_(c.fault, static_cast<double>(plan.controller.period_s)),
          machine_(c.fault) {}

    [[nodiscard]] const study::RigSession& session() const { return session_; }
    [[nodiscard]] const Command& command() const { return command_; }
    [[nodiscard]] const antiskid::can::ControllerView& view() const { return rig_port_.controller(); }
    [[nodiscard]] double driver_mA() const { return driver_.current_mA(); }
    /// Whether the valve's driver hears the controller.
    [[nodiscard]] bool received() const { return driver_.hears(); }
    /// Demand as it is sent; none where it is not armed or the wheel carries no load.
    [[nodiscard]] double asked_Pa() const {
        return asked_.arm && asked_.weight_on_wheels ? plan_.layout.maneuver.demand_Pa.rounded(static_cast<double>(asked_.demand_Pa)) : 0.0;
    }

    void cycle(bool active) {
        const Time now = period_ * steps_;
        const MachineFault::Effect effect = machine_.effect(active, random_);
        send_samples(active, now, effect);
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
            command_ = controller_.step(port_.sensors(), now + effect.clock);
            port_.clear_one_shots();
            answers = static_cast<std::uint32_t>(port_.due_frames(command_, answer));
        }
        for (std::uint32_t i = 0; i < answers; ++i) {
            answer[i].received = now;
            if (effect.bus_off) continue;
            if (on_bus_ && answer[i].id == message_)
                frames_.send(answer[i], active, steps_, random_);
            else
                rig_port_.accept(answer[i]);
        }
        if (on_bus_ && fault_.what.signal == Signal::valve_command) {
            while (auto frame = frames_.receive(steps_)) {
                frame->received = now;
                rig_port_.accept(*frame);
            }
        }
        driver_.update(rig_port_.controller(), rig_port_.stats(Role::valve), now);
        session_.advance(valve_.apply(driver_.current_mA(), active, random_), command_.state);
        ++steps_;
    }

  private:
    static study::SessionOptions options(const FaultPlan& plan, const Case& c, double longest_s) {
        study::SessionOptions session = plan.session(c);
        session.longest_s = longest_s;
        return session;
    }

    void send_samples(bool active, Time now, const MachineFault::Effect& effect) {
        antiskid::can::RigSample sample = session_.sample();
        sample.load_cells = session_.load_cells();
        sample_.apply(sample, session_, active, random_);
        asked_ = sample.maneuver;
        std::array<Frame, RigPort::kMaxFrames> sent{};
        const std::size_t count = rig_port_.due_frames(sample, sent);
        const auto arrive = [&](Frame frame) {
            frame.received = now + effect.clock + effect.stamps;
            if (!effect.bus_off) inbox_.push_back(frame);
        };
        for (std::size_t i = 0; i < count; ++i) {
            if (on_bus_ && sent[i].id == message_)
                frames_.send(sent[i], active, steps_, random_);
            else
                arrive(sent[i]);
        }
        if (fault_.what.signal == Signal::valve_command) return;
        while (const auto frame = frames_.receive(steps_)) arrive(*frame);
    }

    const FaultPlan& plan_;
    Fault fault_;
    rig::Random random_;
    study::RigSession session_;
    Controller controller_;
    Time period_;
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
    std::uint32_t missed_ = 0;
    std::int64_t steps_ = 0;
};

constexpr double kLongest_s = 600.0;

}  // namespace

Sound run_sound(const FaultPlan& plan, const Case& c) {
    Bench bench(plan, c, kLongest_s);
    Sound sound;
    while (!bench.session().done()) {
        bench.cycle(false);
        sound.named.insert(bench.command().faults);
    }
    sound.distance_m = bench.session().figures().stop_distance_m;
    sound.lasts_s = bench.session().rig().time_s();
    if (!sound.named.empty() || !bench.session().rig().standstill())
        throw std::runtime_error(
            fmt::format("the stop on {}, sensor seed {}, names faults or does not come to rest without any fault: "
                        "nothing can be said about it with one",
                        plan.surfaces[c.surface].name, c.sensor_seed));
    return sound;
}

Result run_one(const FaultPlan& plan, const Case& c, const Sound& sound, const study::StepObserver& on_step) {
    constexpr double kPatience = 2.0;  // times the sound run's length: nobody brakes any more
    Bench bench(plan, c, kPatience * sound.lasts_s);
    Judge judge({}, {.sound_distance_m = sound.distance_m,
                     .safe_mA = static_cast<double>(plan.controller.valve.safe_current_mA),
                     .changed_wish = changes_wish(c.fault.what.signal),
                     .emergency_stop = c.fault.what.signal == Signal::emergency_stop});
    Result result;
    Beginning beginning(c, plan.drop_out_mps);
    bool begun = false;
    double ends_s = 0.0;
    while (!bench.session().done()) {
        const double time_s = bench.session().rig().time_s();
        if (!begun && beginning.reached(bench.session())) {
            begun = true;
            ends_s = time_s + c.fault.lasts_s;
            result.begun_s = time_s;
            result.begun_mps = bench.session().rig().wheel().v_mps;
        }
        bench.cycle(begun && time_s < ends_s);
        if (on_step) on_step(bench.session(), bench.view(), bench.driver_mA());
        if (!begun) continue;
        const plant::Rig& rig = bench.session().rig();
        judge.observe({.period_s = static_cast<double>(plan.controller.period_s),
                       .distance_m = bench.session().distance_m(),
                       .v_mps = rig.wheel().v_mps,
                       .slip = rig.forces().slip,
                       .pressure_Pa = rig.pressure_Pa(),
                       .asked_Pa = bench.asked_Pa(),
                       .driver_mA = bench.driver_mA(),
                       .state = bench.command().state,
                       .named = bench.command().faults,
                       .received = bench.received()});
    }
    result.verdict = judge.verdict(bench.session().rig().standstill());
    return result;
}

}  // namespace faults
