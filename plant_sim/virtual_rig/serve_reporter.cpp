#include "plant_sim/virtual_rig/serve_reporter.hpp"

#include <fmt/core.h>

#include <chrono>
#include <utility>

namespace plant_sim {

ServeReporter::ServeReporter(ServeNode& node, antiskid::host::SupervisedCan& bus, std::string interface, double period_s, Say say,
                             ManeuverEnded maneuver_ended)
    : state_(node.state()),
      brakes_(node.brake_states()),
      bus_(bus),
      interface_(std::move(interface)),
      period_s_(period_s),
      say_(std::move(say)),
      maneuver_ended_(std::move(maneuver_ended)),
      thread_([this] { run(); }) {}

ServeReporter::~ServeReporter() {
    stop_ = true;
    thread_.join();
}

void ServeReporter::say(const std::string& what) const {
    say_(fmt::format("{:.3f} s: {}", static_cast<double>(state_.periods.load()) * period_s_, what));
}

void ServeReporter::run() {
    while (!stop_) {
        report_changes();
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    report_changes();
}

void ServeReporter::report_changes() {
    for (wear::BrakeState brake; brakes_.pop(brake);) {
        const std::string text = maneuver_ended_ ? maneuver_ended_(brake) : std::string();
        if (!text.empty()) say(text);
    }
    if (bus_.lost()) {
        const std::string error = bus_.service();
        if (!error.empty() && error != link_error_) say(error);
        link_error_ = error;
    }
    if (const bool up = state_.link_up; up != link_up_) {
        link_up_ = up;
        say(up ? interface_ + " is up again" : interface_ + " is down: nothing is sent, the valve driver gives no current; waiting for it");
    }
    if (const bool received = state_.controller_heard; received != controller_heard_) {
        controller_heard_ = received;
        say(received ? "antiskid-controller is heard: its valve command acts" : "antiskid-controller is silent: the valve driver gives no current");
    }
    if (const plc::Trip trip = state_.trip; trip != trip_) {
        trip_ = trip;
        say(trip == plc::Trip::none ? "PLC reset: ready" : fmt::format("PLC tripped: {}; drive off, sledge back", plc::name(trip)));
    }
    if (const std::uint32_t rejected = state_.rejected; rejected != rejected_) {
        rejected_ = rejected;
        say(fmt::format("PLC refused commit {}: {}", rejected / 256U, plc::name(static_cast<plc::Rejection>(rejected % 256U))));
    }
}

}  // namespace plant_sim
