/// Reports the events of a served rig, one line each, from a thread of its own, so that the rig's thread does not wait for a terminal. The same
/// thread reopens the CAN interface when it is back.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>

#include "firmware/host/supervised_can.hpp"
#include "plant_sim/virtual_rig/serve_node.hpp"

namespace plant_sim {

class ServeReporter {
  public:
    /// Called from the reporter's thread with each line, which begins with the rig time.
    using Say = std::function<void(const std::string&)>;

    /// Called with the brake's state after each maneuver. The returned text is reported unless it is empty.
    using ManeuverEnded = std::function<std::string(const wear::BrakeState&)>;

    /// `node` and `bus` must outlive it. `period_s`: the node's.
    ServeReporter(ServeNode& node, antiskid::host::SupervisedCan& bus, std::string interface, double period_s, Say say,
                  ManeuverEnded maneuver_ended = {});
    ~ServeReporter();
    ServeReporter(const ServeReporter&) = delete;
    ServeReporter& operator=(const ServeReporter&) = delete;

  private:
    void run();
    void report_changes();
    void say(const std::string& what) const;

    const ServeState& state_;
    BrakeStates& brakes_;
    antiskid::host::SupervisedCan& bus_;
    std::string interface_;
    double period_s_;
    Say say_;
    ManeuverEnded maneuver_ended_;
    bool link_up_ = true;
    bool controller_heard_ = false;
    plc::Trip trip_ = plc::Trip::none;
    std::uint32_t rejected_ = 0;
    std::string link_error_;
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

}  // namespace plant_sim
