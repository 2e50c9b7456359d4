#include "firmware/controller/listener.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <initializer_list>
#include <span>
#include <string_view>
#include <vector>

#include "firmware/can/names.hpp"
#include "firmware/can/roles.hpp"
#include "firmware/control/estimator.hpp"
#include "firmware/control/monitor.hpp"
#include "firmware/host/frame_intake.hpp"
#include "firmware/host/pacer.hpp"

namespace antiskid::controller {

namespace {

/// The controller's inputs and checks without its output.
class InputChecks {
  public:
    explicit InputChecks(const control::Config& config)
        : estimator_(config), monitor_(config), safe_Pa_(control::valve_pressure_Pa(config.valve, config.valve.safe_current_mA)) {}

    [[nodiscard]] control::FaultSet step(const control::Sensors& sensors, control::Time now) {
        (void)estimator_.update(sensors, safe_Pa_);
        return monitor_.check(sensors, estimator_, {}, now);
    }
    [[nodiscard]] float wheel_radps() const { return estimator_.wheel_reading().speed_radps; }
    [[nodiscard]] float flywheel_radps() const { return estimator_.flywheel_reading().speed_radps; }

  private:
    control::Estimator estimator_;
    control::Monitor monitor_;
    float safe_Pa_;
};

void note(Reception& reception, control::FaultSet faults, const InputChecks& checks) {
    for (std::size_t i = 0; i < control::kFaultCount; ++i)
        if (faults.contains(static_cast<control::Fault>(i))) ++reception.fault_periods[i];
    reception.wheel_radps = std::max(reception.wheel_radps, std::abs(checks.wheel_radps()));
    reception.flywheel_radps = std::max(reception.flywheel_radps, std::abs(checks.flywheel_radps()));
    const float pressure = reception.sensors.pressure.pressure_Pa;
    if (std::abs(pressure) > std::abs(reception.pressure_Pa)) reception.pressure_Pa = pressure;
}

}  // namespace

std::size_t ListeningBus::receive(std::span<can::Frame> frames) {
    const std::size_t count = bus_.receive(frames);
    for (const can::Frame& frame : frames.first(count))
        for (const can::Role role : can::kToRig)
            if (layout_[role].bound && layout_[role].id == frame.id) ++controller_frames_;
    return count;
}

Reception listen(const controller::ControllerSetup& setup, can::Bus& bus, host::Clock& clock, const control::Time duration,
                 const std::atomic<bool>& stop) {
    ListeningBus overheard(bus, setup.layout);
    can::ControllerPort port(setup.layout, setup.period);
    host::FrameIntake intake(overheard, port);
    host::TimerPacer pacer(clock, setup.period, intake);
    InputChecks checks(setup.control);
    Reception reception;
    const control::Time began = clock.now();
    for (auto wake = pacer.next(stop); wake; wake = pacer.next(stop)) {
        port.note_link(overheard.status());
        reception.sensors = port.sensors();
        const control::FaultSet faults = checks.step(reception.sensors, wake->now);
        port.clear_one_shots();
        ++reception.periods;
        reception.missed_periods += wake->skipped;
        reception.latency.add(wake->latency);
        reception.work.add(clock.now() - wake->woke);
        if (wake->now - began >= Reception::kSettle) note(reception, faults, checks);
        if (wake->now - began >= duration) break;
    }
    for (const can::Role role : can::kToController) reception.stats[static_cast<std::size_t>(role)] = port.stats(role);
    reception.controller_frames = overheard.controller_frames();
    reception.link = overheard.status();
    return reception;
}

namespace {

using can::Role;
using control::Fault;

constexpr float kAtRest_radps = 0.1F;  // as the controller's self-test takes it

/// Faults that a message's absence or damage is known by, and those of what it says.
struct Input {
    Role role;
    std::array<Fault, 2> arrival;
    std::vector<Fault> value;
};

std::vector<Input> sensors() {
    return {{Role::wheel, {Fault::wheel_lost, Fault::wheel_corrupt}, {Fault::wheel_range, Fault::wheel_rate, Fault::wheel_stuck}},
            {Role::flywheel, {Fault::flywheel_lost, Fault::flywheel_corrupt}, {Fault::flywheel_range, Fault::flywheel_rate, Fault::flywheel_stuck}},
            {Role::pressure,
             {Fault::pressure_lost, Fault::pressure_corrupt},
             {Fault::pressure_range, Fault::pressure_rate, Fault::pressure_stuck, Fault::pressure_off_command}}};
}

std::vector<std::string_view> present(const Reception& reception, std::span<const Fault> faults) {
    std::vector<std::string_view> found;
    for (const Fault fault : faults)
        if (reception.faulty(fault)) found.push_back(can::name(fault));
    return found;
}

std::string frames_required(const can::Message& message) {
    return fmt::format("one every {:g} ms, none late, refused or lost", std::chrono::duration<double, std::milli>(message.period).count());
}

std::string frames_name(Role role) {
    return fmt::format("{} frames", can::name(role));
}

/// Expected number of frames.
double expected(const Reception& reception, const controller::ControllerSetup& setup, const can::Message& message) {
    const auto periods = static_cast<double>(reception.periods + reception.missed_periods);
    return periods * std::chrono::duration<double>(setup.period) / message.period;
}

Check frames_check(const Reception& reception, const controller::ControllerSetup& setup, Role role, std::span<const Fault> arrival,
                   const std::string& interface, CheckResult absent) {
    const can::Message& message = setup.layout[role];
    const can::MessageStats& stats = reception.of(role);
    const auto wrong = present(reception, arrival);
    std::string measured = stats.accepted + stats.rejected() == 0
                               ? std::string("none")
                               : fmt::format("{} good, {} refused, {} lost", stats.accepted, stats.rejected(), stats.lost);
    if (!wrong.empty() && stats.accepted > 0) measured += fmt::format(": {}", fmt::join(wrong, ", "));
    const bool silent = stats.accepted + stats.rejected() == 0;
    const bool undamaged = wrong.empty() && stats.accepted > 0 && stats.rejected() == 0 && stats.lost == 0;
    constexpr double kEnough = 0.9;
    const bool enough = stats.accepted >= kEnough * expected(reception, setup, message);
    Check check = judged(frames_name(role), undamaged && enough,
                         {.measured = std::move(measured),
                          .required = frames_required(message),
                          .remedy = silent && absent == CheckResult::warn
                                        ? std::string("start rig-bridge: without it nothing is armed")
                                        : fmt::format("candump {},{:03X}:7FF; then cable, node, DBC and binding", interface, message.id)},
                         silent      ? absent
                         : undamaged ? CheckResult::warn
                                     : CheckResult::fail);
    check.figures = {{"accepted", stats.accepted}, {"rejected", stats.rejected()}, {"lost", stats.lost}};
    return check;
}

Check value_check(const Reception& reception, const Input& input, bool at_rest, std::string measured, std::string required, std::string remedy) {
    const std::string name = fmt::format("{} at rest", can::name(input.role));
    if (reception.of(input.role).accepted == 0) return skipped(name, "no frame", std::move(required));
    const auto wrong = present(reception, input.value);
    if (!wrong.empty()) measured += fmt::format(": {}", fmt::join(wrong, ", "));
    return judged(name, at_rest && wrong.empty(), {.measured = std::move(measured), .required = std::move(required), .remedy = std::move(remedy)});
}

Check shaft_check(const Reception& reception, const Input& input, float speed_radps) {
    return value_check(reception, input, speed_radps < kAtRest_radps, fmt::format("{:.2f} rad/s", speed_radps), "0, plausible",
                       "wait until it stands; else docs/user/faults.md has the fault");
}

Check pressure_check(const Reception& reception, const Input& input, const control::Config& config) {
    const float max = config.supervisor.residual_pressure_Pa;
    return value_check(reception, input, std::abs(reception.pressure_Pa) < max, fmt::format("{:.3f} MPa", reception.pressure_Pa * 1e-6F),
                       fmt::format("below {:.3f} MPa, plausible", max * 1e-6F), "release the brake; else gauge, leak or a spool that sticks");
}

Check stop_check(const Reception& reception) {
    const bool stopped = reception.faulty(Fault::emergency_stop) || reception.of(Role::emergency_stop).accepted > 0;
    return judged("emergency stop", !stopped,
                  {.measured = stopped ? "pressed" : "not pressed", .required = "not pressed", .remedy = "find out who pressed it, then release it"});
}

Check link_check(const Reception& reception) {
    const can::LinkStatus& link = reception.link;
    const bool good = link.up && !link.bus_off && link.error_frames == 0 && link.receive_dropped == 0 && !reception.faulty(Fault::bus_off);
    Check check = judged("CAN while listening", good,
                         {.measured = fmt::format("{}, {} error frames, {} dropped",
                                                  link.bus_off ? "bus-off"
                                                  : link.up    ? "up"
                                                               : "down",
                                                  link.error_frames, link.receive_dropped),
                          .required = "up, no error frame, none dropped",
                          .remedy = "termination and bit rate; dropped: sysctl -w net.core.rmem_max=1048576"});
    check.figures = {{"error_frames", link.error_frames}, {"dropped", link.receive_dropped}};
    return check;
}

Check alone_check(const Reception& reception, const std::string& interface) {
    return judged("only controller", reception.controller_frames == 0,
                  {.measured = reception.controller_frames == 0 ? std::string("no other")
                                                                : fmt::format("another one sent {} frames", reception.controller_frames),
                   .required = "no other",
                   .remedy = fmt::format("systemctl stop antiskid-controller@{}, or end it by Ctrl-C", interface)});
}

double us(control::Time time) {
    return std::chrono::duration<double, std::micro>(time).count();
}

Check duration_check(const std::string& name, const host::Histogram& histogram, control::Time judged_one, std::string_view which, control::Time max) {
    Check check = judged(name, judged_one <= max,
                         {.measured = fmt::format("p50 {:.1f}, p99 {:.1f}, p99.9 {:.1f}, max {:.1f} us", us(histogram.percentile(0.5)),
                                                  us(histogram.percentile(0.99)), us(histogram.percentile(0.999)), us(histogram.maximum())),
                          .required = fmt::format("{} at most {:.0f} us", which, us(max)),
                          .remedy = "docs/user/real_time.md, step by step"});
    check.figures = {{"p50_us", us(histogram.percentile(0.5))},
                     {"p99_us", us(histogram.percentile(0.99))},
                     {"p99_9_us", us(histogram.percentile(0.999))},
                     {"max_us", us(histogram.maximum())}};
    return check;
}

}  // namespace

Checks frame_checks(const Reception& reception, const controller::ControllerSetup& setup, const std::string& interface) {
    Checks checks;
    for (const Input& input : sensors()) checks.push_back(frames_check(reception, setup, input.role, input.arrival, interface, CheckResult::fail));
    const auto inputs = sensors();
    checks.push_back(shaft_check(reception, inputs[0], reception.wheel_radps));
    checks.push_back(shaft_check(reception, inputs[1], reception.flywheel_radps));
    checks.push_back(pressure_check(reception, inputs[2], setup.control));
    constexpr std::array kManeuver{Fault::maneuver_lost, Fault::maneuver_corrupt, Fault::maneuver_range};
    constexpr std::array kHeartbeat{Fault::heartbeat_lost};
    checks.push_back(frames_check(reception, setup, Role::maneuver, kManeuver, interface, CheckResult::warn));
    checks.push_back(frames_check(reception, setup, Role::rig_heartbeat, kHeartbeat, interface, CheckResult::warn));
    checks.push_back(stop_check(reception));
    checks.push_back(link_check(reception));
    checks.push_back(alone_check(reception, interface));
    return checks;
}

Checks frame_checks_skipped(const controller::ControllerSetup& setup, const std::string& why) {
    Checks checks;
    for (const Role role : {Role::wheel, Role::flywheel, Role::pressure, Role::maneuver, Role::rig_heartbeat})
        checks.push_back(skipped(frames_name(role), why, frames_required(setup.layout[role])));
    return checks;
}

Checks timing_checks(const Reception& reception, const control::Time period) {
    Checks checks{duration_check("loop latency", reception.latency, reception.latency.percentile(0.999), "p99.9", period / 5),
                  duration_check("loop work", reception.work, reception.work.maximum(), "max", period / 2)};
    checks.push_back(judged("missed periods", reception.missed_periods == 0 && reception.periods > 0,
                            {.measured = fmt::format("{} of {}", reception.missed_periods, reception.missed_periods + reception.periods),
                             .required = "none",
                             .remedy = "docs/user/real_time.md, step by step"}));
    return checks;
}

std::string why_not_to_move_the_valve(const Reception& reception, const control::Config& config) {
    for (const Input& input : sensors()) {
        if (reception.of(input.role).accepted == 0) return fmt::format("no {} frames", can::name(input.role));
        auto wrong = present(reception, input.arrival);
        const auto values = present(reception, input.value);
        wrong.insert(wrong.end(), values.begin(), values.end());
        if (!wrong.empty()) return std::string(wrong.front());
    }
    if (reception.wheel_radps >= kAtRest_radps) return "the wheel turns";
    if (reception.flywheel_radps >= kAtRest_radps) return "the flywheel turns";
    if (std::abs(reception.pressure_Pa) >= config.supervisor.residual_pressure_Pa) return "there is pressure";
    if (reception.of(Role::emergency_stop).accepted > 0) return "the emergency stop is pressed";
    if (reception.controller_frames > 0) return "another controller commands the valve";
    if (!reception.link.up || reception.link.bus_off) return "the link is down";
    return {};
}

}  // namespace antiskid::controller
